#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <zwang/core/problem/types.h>
#include <zwang/core/referee/double_double.h>

namespace zwang {

// A symmetric positive definite matrix in double-double: the lower triangle by columns, high and low parts apart, so
// that a column is worked on by vector instructions. Sums keep some 100 bits (compensated as by Ogita, Rump & Oishi
// 2005), for directions, not for bounds.
class ExtendedSymmetric {
 public:
  explicit ExtendedSymmetric(Index size)
      : n_(static_cast<std::size_t>(size)), high_(n_ * n_), low_(n_ * n_), column_high_(n_), column_low_(n_) {}

  void set_zero() {
    std::ranges::fill(high_, 0);
    std::ranges::fill(low_, 0);
  }
  void add(Index row, Index column, double value) {  // row >= column
    const std::size_t at = static_cast<std::size_t>(row) + static_cast<std::size_t>(column) * n_;
    const DoubleDouble sum = DoubleDouble(high_[at], low_[at]) + value;
    high_[at] = sum.hi;
    low_[at] = sum.lo;
  }
  // += b b'
  void add_square(const ExtendedVector& b) {
    for (std::size_t i = 0; i < n_; ++i) {
      column_high_[i] = b[i].hi;
      column_low_[i] = b[i].lo;
    }
    for (std::size_t j = 0; j < n_; ++j)
      if (b[j].hi != 0) add_scaled(column_high_.data(), column_low_.data(), b[j], j);
  }

  // Cholesky, in place. False where a pivot is not positive.
  bool factorize() {
    for (std::size_t j = 0; j < n_; ++j) {
      for (std::size_t k = 0; k < j; ++k)
        if (const DoubleDouble factor = entry(j, k); factor.hi != 0)
          add_scaled(&high_[k * n_], &low_[k * n_], -factor, j);
      const DoubleDouble pivot = entry(j, j);
      if (!(pivot.hi > 0) || !std::isfinite(pivot.hi)) return false;
      const DoubleDouble root = sqrt(pivot);
      for (std::size_t i = j; i < n_; ++i) {
        const DoubleDouble value = i == j ? root : entry(i, j) / root;
        high_[i + j * n_] = value.hi;
        low_[i + j * n_] = value.lo;
      }
    }
    return true;
  }

  void solve(ExtendedVector& x) const {
    for (std::size_t j = 0; j < n_; ++j) {
      x[j] /= entry(j, j);
      for (std::size_t i = j + 1; i < n_; ++i) x[i] -= x[j] * entry(i, j);
    }
    for (std::size_t j = n_; j-- > 0;) {
      for (std::size_t i = j + 1; i < n_; ++i) x[j] -= x[i] * entry(i, j);
      x[j] /= entry(j, j);
    }
  }

 private:
  DoubleDouble entry(std::size_t i, std::size_t j) const {
    const double high = high_[i + j * n_], low = low_[i + j * n_];
    return DoubleDouble::exact_sum(high, low);
  }
  // Column j from its diagonal on: += b factor.
  void add_scaled(const double* b_high, const double* b_low, const DoubleDouble& factor, std::size_t j) {
    double* __restrict high = &high_[j * n_];
    double* __restrict low = &low_[j * n_];
    for (std::size_t i = j; i < n_; ++i) {
      const double product = b_high[i] * factor.hi, rest = std::fma(b_high[i], factor.hi, -product);
      const double sum = high[i] + product, part = sum - high[i];
      low[i] += ((high[i] - (sum - part)) + (product - part)) + (rest + (b_high[i] * factor.lo + b_low[i] * factor.hi));
      high[i] = sum;
    }
  }

  std::size_t n_;
  std::vector<double> high_, low_, column_high_, column_low_;
};

}  // namespace zwang
