#pragma once

#include <zwang/solvers/linalg/line_matrix.h>

namespace zwang {

// Orthonormal columns Q of the rows that are active, A_active' = Q R, and T = R^-1 instead of R: an entering row then
// needs products only (r = T Q'a, and T's new column is -r / length), no back substitution whose steps wait for each
// other. An inverse loses digits as the condition squared at worst: this is for clear problems
// (dense_dual_active_set.h). A step costs as many columns as there are active rows.
// (What was tried in its place: docs/notes/performance.md, factors.)
class InverseFactor {
 public:
  // No rows, of `padded` entries each, and room for `most` of them (both multiples of eight); allocates only to grow.
  void reset(Index padded, Index most);
  Index size() const { return size_; }

  // a = Q d + remainder, d = Q'a and r = T d; returns the remainder's length.
  double split(const double* a);
  const double* remainder() const { return remainder_.data(); }
  const Vector& r() const { return r_; }  // zero from size() to the next multiple of eight
  // The row that was split enters.
  void append();
  void drop(Index j);

  // The dv and dmu with dv - A'dmu = s and A dv = sigma. All of them padded.
  void solve(const Vector& s, const Vector& sigma, Vector& dv, Vector& dmu);

 private:
  Index padded_ = 0, size_ = 0;
  double length_ = 0;
  lanes::Columns Q_, T_;
  Vector d_, r_, again_, remainder_;
  Vector cosine_, sine_;  // of a drop()
};

}  // namespace zwang
