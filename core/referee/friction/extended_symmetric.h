#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <zwang/core/number/double_double.h>
#include <zwang/core/problem/types.h>

namespace zwang {

// A symmetric matrix [[A, E'], [E, 0]] in double-double, A positive definite and the rows of E independent: L S L' with
// L lower triangular and S = +1 on A, -1 on the rest needs no pivots. The lower triangle by columns, high and low parts
// apart, so that a column is worked on by vector instructions. Sums keep some 100 bits (compensated as by Ogita, Rump &
// Oishi 2005), for directions, not for bounds.
class ExtendedSymmetric {
 public:
  // positive: of A; negative: of E.
  ExtendedSymmetric(Index positive, Index negative)
      : n_(at(positive + negative)), positive_(at(positive)), high_(n_ * n_), low_(n_ * n_) {}

  void set_zero() {
    std::ranges::fill(high_, 0);
    std::ranges::fill(low_, 0);
  }
  // What is above the diagonal is left out.
  void add(Index row, Index column, const DoubleDouble& value) {
    if (row < column) return;
    const auto i = at(row), j = at(column);
    put(i, j, entry(i, j) + value);
  }
  // left right', symmetric, at the top left.
  void add_product(const Matrix& left, const MatrixX<DoubleDouble>& right) {
    const std::vector<double> nothing(n_);
    for (Index k = 0; k < left.cols(); ++k)
      for (Index j = 0; j < left.rows(); ++j)
        subtract(left.col(k).data(), nothing.data(), -right(j, k), at(j), at(left.rows()));
  }

  // In place. False where a pivot has the wrong sign.
  bool factorize() {
    for (std::size_t j = 0; j < n_; ++j) {
      for (std::size_t k = 0; k < j; ++k)
        if (const DoubleDouble factor = entry(j, k); factor.hi != 0)
          subtract(&high_[k * n_], &low_[k * n_], k < positive_ ? factor : -factor, j, n_);
      const DoubleDouble pivot = signed_by(j, entry(j, j));
      if (!(pivot.hi > 0) || !std::isfinite(pivot.hi)) return false;
      const DoubleDouble root = sqrt(pivot);
      for (std::size_t i = j; i < n_; ++i) put(i, j, i == j ? root : signed_by(j, entry(i, j)) / root);
    }
    return true;
  }

  void solve(VectorX<DoubleDouble>& b) const {
    const auto x = [&](std::size_t j) -> DoubleDouble& { return b[static_cast<Index>(j)]; };
    for (std::size_t j = 0; j < n_; ++j) {
      x(j) /= entry(j, j);
      for (std::size_t i = j + 1; i < n_; ++i) x(i) -= x(j) * entry(i, j);
    }
    for (std::size_t j = n_; j-- > 0;) {
      x(j) = signed_by(j, x(j));
      for (std::size_t i = j + 1; i < n_; ++i) x(j) -= x(i) * entry(i, j);
      x(j) /= entry(j, j);
    }
  }

 private:
  DoubleDouble signed_by(std::size_t j, const DoubleDouble& x) const { return j < positive_ ? x : -x; }
  DoubleDouble entry(std::size_t i, std::size_t j) const {
    return DoubleDouble::exact_sum(high_[i + j * n_], low_[i + j * n_]);
  }
  void put(std::size_t i, std::size_t j, const DoubleDouble& value) {
    high_[i + j * n_] = value.hi;
    low_[i + j * n_] = value.lo;
  }
  // Column j from its diagonal to `end`: -= a column b times the factor.
  void subtract(const double* b_high, const double* b_low, const DoubleDouble& factor, std::size_t j, std::size_t end) {
    double* __restrict high = &high_[j * n_];
    double* __restrict low = &low_[j * n_];
    for (std::size_t i = j; i < end; ++i) {
      const double product = b_high[i] * -factor.hi, rest = std::fma(b_high[i], -factor.hi, -product);
      const double sum = high[i] + product, part = sum - high[i];
      low[i] += ((high[i] - (sum - part)) + (product - part)) + (rest - (b_high[i] * factor.lo + b_low[i] * factor.hi));
      high[i] = sum;
    }
  }

  std::size_t n_, positive_;
  std::vector<double> high_, low_;
};

}  // namespace zwang
