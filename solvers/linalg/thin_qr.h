#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/types.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The factors A = Q R of a growing and shrinking list of columns, Q orthonormal, R upper triangular with positive
// pivots, by orthogonal updates only.
//
// Daniel, Gragg, Kaufman & Stewart, Reorthogonalization and stable algorithms for updating the Gram-Schmidt QR
// factorization (1976): a new column is orthogonalized against Q, and again by Kahan's criterion, which leaves Q
// orthonormal to rounding whatever the remainder; a column leaves by Givens rotations. Only the thin Q is kept: its
// complement, which Goldfarb & Idnani carry along, would cost an n x (n - q) rotation a step and gives nothing that the
// remainder does not.
//
// Both ways cost O(rows x size), where a fresh factorization costs O(rows x size^2). Tried before: Householder
// reflectors kept in place; dropping a column then means refactoring everything to its right.
template <class Scalar>
class BasicThinQr {
 public:
  // Empty again, with room for `capacity` columns of length `rows`. Allocates only when the room must grow.
  void reset(Index rows, Index capacity) {
    capacity_ = std::min(rows, capacity);
    if (Q_.rows() != rows || Q_.cols() < capacity_) Q_.resize(rows, capacity_);
    if (R_.rows() < capacity_) {
      R_.resize(capacity_, capacity_);
      d_.resize(capacity_);
      correction_.resize(capacity_);
    }
    remainder_.resize(rows);
    size_ = 0;
  }

  Index size() const { return size_; }
  auto Q() const { return Q_.leftCols(size_); }
  // x := R^-1 x and x := R^-T x.
  template <class Column>
  void solve(Column&& x) const {
    R_.topLeftCorner(size_, size_).template triangularView<Eigen::Upper>().solveInPlace(x);
  }
  template <class Column>
  void solve_transposed(Column&& x) const {
    R_.topLeftCorner(size_, size_).transpose().template triangularView<Eigen::Lower>().solveInPlace(x);
  }
  Scalar pivot(Index j) const { return R_(j, j); }

  // a = Q d + remainder, the remainder orthogonal to Q. Returns its length.
  template <class Column>
  Scalar split(const Column& a) {
    length_ = share(a);
    if (length_ * length_ >= tolerances::orthogonalize_again * a.squaredNorm()) return length_;
    auto correction = correction_.head(size_);
    correction.noalias() = Q().transpose() * remainder_;
    remainder_.noalias() -= Q() * correction;
    d_.head(size_) += correction;
    return length_ = remainder_.norm();
  }
  // That length alone, to rounding in `a`, by one pass over what lies between the zeros of `a` (a contact meets two
  // bodies). The column is not to be appended.
  template <class Column>
  Scalar share(const Column& a) {
    Index begin = 0, end = a.size();
    while (begin < end && a[begin] == Scalar(0)) ++begin;
    while (begin < end && a[end - 1] == Scalar(0)) --end;
    auto d = d_.head(size_);
    d.noalias() = Q().middleRows(begin, end - begin).transpose() * a.segment(begin, end - begin);
    remainder_ = a;
    remainder_.noalias() -= Q() * d;
    return remainder_.norm();
  }
  auto components() const { return d_.head(size_); }
  const VectorX<Scalar>& remainder() const { return remainder_; }

  // Appends the column that was split last; its remainder must not be zero.
  void append() {
    R_.col(size_).head(size_) = d_.head(size_);
    R_(size_, size_) = length_;
    Q_.col(size_) = remainder_ / length_;
    ++size_;
  }
  // Appends `a` when its part outside span(Q) is longer than `threshold` |a|; returns that part's share of |a| (its
  // relative pivot) either way. Columns beyond the capacity are dependent by counting: 0.
  template <class Column>
  Scalar append(const Column& a, const Scalar& threshold) {
    const Scalar length = a.norm();
    if (size_ == capacity_ || !(length > 0)) return Scalar(0);
    const Scalar share = split(a) / length;
    if (share > threshold) append();
    return share;
  }

  // Takes column `at` out. The rotations that restore the triangle are applied to Q, and to `rotated` = Q'f when given:
  // afterwards Q's column size() and rotated[size()] hold the direction that left the span and f's part along it.
  void drop(Index at, Scalar* rotated = nullptr) {
    using std::hypot;
    for (Index j = at; j + 1 < size_; ++j) R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
    for (Index j = at; j + 1 < size_; ++j) {
      const Scalar a = R_(j, j), b = R_(j + 1, j), length = hypot(a, b);
      const Scalar c = length > 0 ? Scalar(a / length) : Scalar(1), s = length > 0 ? Scalar(b / length) : Scalar(0);
      const auto rotate = [&](Scalar& x, Scalar& y) {
        const Scalar t = c * x + s * y;
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
  Index size_ = 0, capacity_ = 0;
  MatrixX<Scalar> Q_, R_;
  VectorX<Scalar> d_, correction_, remainder_;
  Scalar length_{0};
};

using ThinQr = BasicThinQr<double>;

}  // namespace zwang
