#pragma once

#include <Eigen/Jacobi>
#include <cmath>

#include <zwang/core/problem/types.h>

namespace zwang {

// The factors A = Q R of a changing set of columns, Q orthonormal, R upper triangular, by orthogonal updates only.
//
// Daniel, Gragg, Kaufman & Stewart, Reorthogonalization and stable algorithms for updating the Gram-Schmidt QR
// factorization (1976): a new column is orthogonalized twice against Q, which leaves Q orthonormal to rounding whatever
// the remainder; a column leaves by Givens rotations. Only the thin Q is kept: its complement, which Goldfarb & Idnani
// carry along, would cost an n x (n - q) rotation a step and gives nothing that the remainder does not.
template <class Scalar>
class OrthogonalUpdates {
 public:
  // No columns; room for `capacity` of length n. Allocates only when the room must grow.
  void reset(Index n, Index capacity) {
    if (Q_.rows() != n || Q_.cols() < capacity) Q_.resize(n, capacity);
    if (R_.rows() < capacity) {
      R_.resize(capacity, capacity);
      d_.resize(capacity);
      correction_.resize(capacity);
    }
    remainder_.resize(n);
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
    auto d = d_.head(size_);
    auto correction = correction_.head(size_);
    d.noalias() = Q().transpose() * a;
    remainder_ = a;
    remainder_.noalias() -= Q() * d;
    correction.noalias() = Q().transpose() * remainder_;
    remainder_.noalias() -= Q() * correction;
    d += correction;
    length_ = remainder_.norm();
    return length_;
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

  // Takes column j out: the Hessenberg part of R to its right becomes triangular again.
  void remove(Index j) {
    for (Index k = j; k + 1 < size_; ++k) R_.col(k).head(k + 2) = R_.col(k + 1).head(k + 2);
    --size_;
    for (Index k = j; k < size_; ++k) {
      Eigen::JacobiRotation<Scalar> rotation;
      rotation.makeGivens(R_(k, k), R_(k + 1, k), &R_(k, k));
      R_(k + 1, k) = Scalar(0);
      if (k + 1 < size_) R_.middleCols(k + 1, size_ - k - 1).applyOnTheLeft(k, k + 1, rotation.adjoint());
      Q_.applyOnTheRight(k, k + 1, rotation);
    }
  }

 protected:
  Index size_ = 0;
  MatrixX<Scalar> Q_, R_;
  VectorX<Scalar> d_, correction_, remainder_;
  Scalar length_{0};
};

}  // namespace zwang
