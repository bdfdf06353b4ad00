#pragma once

#include <numeric>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// Disjoint sets of 0..n-1, with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(static_cast<std::size_t>(n)) {
    std::iota(parent_.begin(), parent_.end(), Index(0));
  }
  Index find(Index i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  void join(Index a, Index b) { at(find(a)) = find(b); }

 private:
  Index& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }

  std::vector<Index> parent_;
};

}  // namespace zwang
