#pragma once

#include <algorithm>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// The sparsity pattern of a compressed matrix; no other one ever matches. What depends on the pattern alone (which
// bodies a row couples, which islands there are) is reused between frames as long as the pattern stays the same:
// comparing patterns is much cheaper than deriving these again.
class SparsityPattern {
 public:
  template <class Sparse>
  bool matches(const Sparse& A) const {
    const auto outer = static_cast<std::size_t>(A.outerSize()) + 1, inner = static_cast<std::size_t>(A.nonZeros());
    return A.isCompressed() && A.innerSize() == inner_size_ && outer_.size() == outer && inner_.size() == inner &&
           std::equal(outer_.begin(), outer_.end(), A.outerIndexPtr()) &&
           std::equal(inner_.begin(), inner_.end(), A.innerIndexPtr());
  }
  template <class Sparse>
  void keep(const Sparse& A) {
    inner_size_ = -1;
    if (!A.isCompressed()) return;
    inner_size_ = A.innerSize();
    outer_.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
    inner_.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
  }

 private:
  Index inner_size_ = -1;
  std::vector<int> outer_, inner_;
};

}  // namespace zwang
