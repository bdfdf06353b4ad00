#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/orthogonal_updates.h>

namespace zwang {

// A = Q R of a growing and shrinking list of columns (orthogonal_updates.h), for methods that decide on appending how
// dependent a column is, and that carry a vector Q'f along.
//
// Both ways cost O(rows x size), where a fresh factorization costs O(rows x size^2). Tried before: Householder
// reflectors kept in place; dropping a column then means refactoring everything to its right.
class ThinQr : private OrthogonalUpdates<double> {
 public:
  using OrthogonalUpdates::pivot;
  using OrthogonalUpdates::Q;
  using OrthogonalUpdates::size;
  using OrthogonalUpdates::solve;
  using OrthogonalUpdates::solve_transposed;

  // Empty again, with room for `capacity` columns.
  void reset(Index rows, Index capacity) {
    capacity_ = std::min(rows, capacity);
    OrthogonalUpdates::reset(rows, capacity_);
  }

  // Appends `a` when its part outside span(Q) is longer than `threshold` |a|; returns that part's share of |a| (its
  // relative pivot) either way. Columns beyond the capacity are dependent by counting: 0.
  template <class Column>
  double append(const Column& a, double threshold) {
    const double length = a.norm();
    if (size_ == capacity_ || !(length > 0)) return 0;
    const double share = split(a) / length;
    if (share > threshold) OrthogonalUpdates::append();
    return share;
  }

  // Takes column `at` out. The rotations that restore the triangle are applied to Q, and to `rotated` = Q'f when given:
  // afterwards Q's column size() and rotated[size()] hold the direction that left the span and f's part along it. They
  // keep the pivots positive, which those of remove() do not.
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

 private:
  Index capacity_ = 0;
};

}  // namespace zwang
