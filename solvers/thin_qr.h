#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types.h"

namespace zwang {

// A = Q R of a growing and shrinking list of columns: Q (rows x size) with orthonormal columns, R upper triangular.
//
// Gram-Schmidt, twice ("twice is enough": Daniel, Gragg, Kaufman & Stewart 1976, Math. Comp. 30), keeps Q orthonormal
// to rounding; a dropped column is taken out by Givens rotations. Both cost O(rows x size), where a fresh
// factorization costs O(rows x size^2). Tried before: Householder reflectors kept in place; dropping a column then
// means refactoring everything to its right.
// All storage is kept between uses: no allocation once the largest shape has been seen.
class ThinQr {
 public:
  // Empty again, with room for `capacity` columns.
  void reset(Index rows, Index capacity) {
    capacity = std::min(rows, capacity);
    if (Q_.rows() != rows || Q_.cols() < capacity) Q_.resize(rows, capacity);
    if (R_.rows() < capacity) R_.resize(capacity, capacity);
    if (column_.size() != rows) column_.resize(rows);
    if (again_.size() < capacity) again_.resize(capacity);
    capacity_ = capacity;
    size_ = 0;
  }

  Index size() const { return size_; }
  auto Q() const { return Q_.leftCols(size_); }
  double pivot(Index i) const { return std::abs(R_(i, i)); }

  // Appends `a` when its part outside span(Q) is longer than `threshold` |a|; returns that part's share of |a| (its
  // relative pivot) either way. Columns beyond the capacity are dependent by counting: 0.
  template <class Column>
  double append(const Column& a, double threshold) {
    const double length = a.norm();
    if (size_ == capacity_ || !(length > 0)) return 0;
    auto r = R_.col(size_).head(size_);
    column_ = a;
    r.noalias() = Q().transpose() * column_;
    column_.noalias() -= Q() * r;
    auto correction = again_.head(size_);
    correction.noalias() = Q().transpose() * column_;
    column_.noalias() -= Q() * correction;
    r += correction;
    const double rest = column_.norm();
    const double share = rest / length;
    if (!(share > threshold)) return share;
    R_(size_, size_) = rest;
    Q_.col(size_) = column_ / rest;
    ++size_;
    return share;
  }

  // Takes column `at` out. The rotations that restore the triangle are applied to Q, and to `rotated` = Q'f when given:
  // afterwards Q's column size() and rotated[size()] hold the direction that left the span and f's part along it.
  void drop(Index at, double* rotated = nullptr) {
    for (Index j = at; j + 1 < size_; ++j) R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
    for (Index j = at; j + 1 < size_; ++j) {
      const double a = R_(j, j), b = R_(j + 1, j), length = std::hypot(a, b);
      const double c = length > 0 ? a / length : 1, s = length > 0 ? b / length : 0;
      const auto rotate = [&](double& x, double& y) {
        const double t = c * x + s * y;
        y = c * y - s * x;
        x = t;
      };
      for (Index k = j; k + 1 < size_; ++k) rotate(R_(j, k), R_(j + 1, k));
      for (Index k = 0; k < Q_.rows(); ++k) rotate(Q_(k, j), Q_(k, j + 1));
      if (rotated) rotate(rotated[j], rotated[j + 1]);
    }
    --size_;
  }
  auto dropped() const { return Q_.col(size_); }

  // x = R^-1 x and x = R^-T x, in place.
  template <class X>
  void solve_R(X&& x) const {
    R_.topLeftCorner(size_, size_).template triangularView<Eigen::Upper>().solveInPlace(x);
  }
  template <class X>
  void solve_Rt(X&& x) const {
    R_.topLeftCorner(size_, size_).transpose().template triangularView<Eigen::Lower>().solveInPlace(x);
  }

 private:
  Matrix Q_ = {}, R_ = {};
  Vector column_ = {}, again_ = {};
  Index size_ = 0, capacity_ = 0;
};

}  // namespace zwang
