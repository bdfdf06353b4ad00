#pragma once

#include <vector>

#include <zwang/core/problem/deadline.h>

namespace zwang {

using Lists = std::vector<std::vector<int>>;

void sort_unique(std::vector<int>& list);

// The elimination tree in postorder: group order[k] is eliminated k-th, below[k] are the later ones it meets then, the
// first of them its parent.
struct Elimination {
  std::vector<int> order;
  Lists below;
  int parent(int k) const {
    const std::vector<int>& later = below[at(k)];
    return later.empty() ? -1 : later.front();
  }
};

// near[i]: the groups that i is coupled to, itself left out. Ordered by minimum degree.
Elimination eliminate(const Lists& near, const Deadline& deadline);

}  // namespace zwang
