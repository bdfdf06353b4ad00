#pragma once

#include <algorithm>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// The sparsity pattern of a matrix, and where its entries lie in memory. What depends on the pattern alone (which
// bodies a row couples, which islands there are) is reused between frames as long as the pattern stays the same:
// comparing patterns is much cheaper than deriving these again.
class SparsityPattern {
 public:
  template <class Sparse>
  bool matches(const Sparse& A) const {
    const auto outer = at(A.outerSize()) + 1;
    if (A.innerSize() != inner_size_ || outer_.size() != outer ||
        !std::equal(outer_.begin(), outer_.end(), A.outerIndexPtr()))
      return false;
    if (A.isCompressed()) return count_.empty() && std::equal(inner_.begin(), inner_.end(), A.innerIndexPtr());
    return count_.size() + 1 == outer && std::equal(count_.begin(), count_.end(), A.innerNonZeroPtr()) &&
           each_run(A, [this](std::size_t begin, const auto* run, auto length) {
             return std::equal(run, run + length, inner_.begin() + static_cast<std::ptrdiff_t>(begin));
           });
  }
  template <class Sparse>
  void keep(const Sparse& A) {
    inner_size_ = A.innerSize();
    outer_.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
    count_.clear();
    inner_.clear();
    if (A.isCompressed()) {
      inner_.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
      return;
    }
    count_.assign(A.innerNonZeroPtr(), A.innerNonZeroPtr() + A.outerSize());
    each_run(A, [this](std::size_t, const auto* run, auto length) {
      inner_.insert(inner_.end(), run, run + length);
      return true;
    });
  }

 private:
  // The columns (rows, in row order) of a matrix with gaps: whether all of them satisfy `test`.
  template <class Sparse, class Test>
  static bool each_run(const Sparse& A, Test&& test) {
    std::size_t begin = 0;
    for (Index j = 0; j < A.outerSize(); ++j) {
      const auto length = A.innerNonZeroPtr()[j];
      if (!test(begin, A.innerIndexPtr() + A.outerIndexPtr()[j], length)) return false;
      begin += at(length);
    }
    return true;
  }

  Index inner_size_ = -1;
  std::vector<int> outer_, inner_, count_;  // count_: entries of each column; empty without gaps between them
};

}  // namespace zwang
