#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// Disjoint sets of 0..n-1, with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(Index n = 0) { reset(n); }
  void reset(Index n) {
    parent_.resize(static_cast<std::size_t>(n));
    std::iota(parent_.begin(), parent_.end(), Index(0));
  }
  Index find(Index i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  // What is found of both is then the smaller one of what was. False: they were together.
  bool join(Index a, Index b) {
    a = find(a);
    b = find(b);
    at(std::max(a, b)) = std::min(a, b);
    return a != b;
  }

 private:
  Index& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }

  std::vector<Index> parent_;
};

}  // namespace zwang
