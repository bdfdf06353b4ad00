#pragma once

#include <zwang/solvers/joint_space/lanes.h>

namespace zwang {

// Orthonormal columns Q of the rows that are active, A_active' = Q R, and T = R^-1 instead of R: an entering row then
// needs products only (r = T Q'a, and T's new column is -r / length), no back substitution whose steps wait for each
// other. An inverse loses digits as the condition squared at worst: this is for clear problems (dense_dual_active_set.h).
//
// Tried: R with back substitution (0.25 us a step more at 20 active rows); one reflection when a row leaves (T loses
// its triangle, and a row that came late no longer leaves at the cost of a few columns: 12 % of a solve more with 64
// contacts); a second orthogonalization always (it is needed only where the first one shortens the column, Kahan's
// criterion).
class InverseFactor {
 public:
  // No rows, of `padded` entries each, and room for `most` of them (both multiples of eight); allocates only to grow.
  void reset(Index padded, Index most);
  Index size() const { return size_; }

  // a = Q d + remainder and r = T d; returns the remainder's length. `d` is Q'a where that is known already.
  double split(const double* a);
  double split_known(const double* a, const double* d, Index stride);
  const double* remainder() const { return remainder_.data(); }
  const Vector& r() const { return r_; }  // zero from size() to the next multiple of eight
  // The row that was split enters.
  void append();
  void drop(Index j);
  // What the last drop() did to Q, done to A Q.
  void follow(lanes::Columns& AQ, Index rows) const;

  // x := R^-T x, x := R^-1 x, and Q'w, Q x, over the active rows; x holds at least the room.
  void solve_transposed(Vector& x) const;
  void solve(Vector& x) const;
  void project(const Vector& w, Vector& x) const;
  void combine(const Vector& x, Vector& w) const;
  const double* column(Index j) const { return Q_.col(j).data(); }

 private:
  double split_off(const double* a);

  Index padded_ = 0, size_ = 0;
  double length_ = 0;
  lanes::Columns Q_, T_;
  Vector d_, r_, again_, remainder_;
  Vector cosine_, sine_;  // of the last drop(), from column dropped_ on
  Index dropped_ = 0;
  mutable Vector x_;
};

}  // namespace zwang
