#pragma once

#include <zwang/solvers/joint_space/row_lanes.h>

namespace zwang {

// The active rows A (q x n) of a small problem as [N, Z], the inverse of [A; Z']: N = A^+ (n x q), and Z an orthonormal
// basis of what the rows leave free. A row that enters takes the place of a column of Z, one that leaves gives it back.
//
// Split a = A'r + remainder: one product with a, which has few entries, gives r = N'a and t = Z'a; remainder = Z t, and
// its length is that of t. Nothing is orthogonalized twice, as Gram and Schmidt's projection a - Q Q'a has to be where
// little is left, and the length of a dependent row is rounding however ill-conditioned the active rows are: Z only
// meets reflections and, where a row leaves, the direction of its column of N, orthogonalized against Z. N loses digits
// as the condition squared at worst: this is for clear problems (dense_dual_active_set.h).
//
// All n columns are there from the beginning, so a step costs n^2, however few rows are active.
class ExchangeBasis {
 public:
  // No rows. `padded`: n up to whole lanes. Allocates only after another size, and nothing where it was reserved.
  void reset(Index n, Index padded);
  void reserve(Index n, Index padded);
  Index size() const { return size_; }

  // r and t of row i; returns the length of the remainder.
  double split(const RowLanes& rows, Index i);
  // Of the row that was split.
  const double* find_remainder();
  const double* r() const { return r_.data(); }  // zero from size() on
  // The row that was split, and whose remainder was found, enters behind the others.
  void append();
  // Row j leaves; the last one takes its number.
  void drop(Index j);

  // The dv and dmu with dv - A'dmu = s and A dv = sigma. All of them padded().
  void solve(const Vector& s, const Vector& sigma, Vector& dv, Vector& dmu);

 private:
  // y = (or +=) [N, Z] t for t that is zero before `from`; x = [N, Z]'w, the first `to` of it.
  template <bool add>
  void multiply(const double* t, Index from, double* y) const;
  void multiply_transposed(const double* w, Index to, double* x) const;
  void add_products(const double* x, const double* y, Index from, Index to);

  Index n_ = 0, padded_ = 0, used_ = 0, size_ = 0;  // used_: n up to whole packets
  double length_ = 0;
  lanes::Columns U_;  // [N, Z]', padded x n: column k is row k of [N, Z]
  Vector r_, t_, remainder_, x_;
};

}  // namespace zwang
