#pragma once

#include <Eigen/SparseCholesky>
#include <memory>

#include <zwang/core/number/double_double.h>
#include <zwang/core/problem/problem.h>

namespace zwang {

using ExtendedVector = VectorX<DoubleDouble>;

namespace referee {

// Entry i times 2^exponents[i].
ExtendedVector scaled(const ExtendedVector& x, const Eigen::ArrayXi& exponents);
int exponent_of(double x);  // the e of x = f 2^e with 1/2 <= f < 1; 0 for 0

}  // namespace referee

// A problem in the referee's units. Distances are taken in the M-norm, |d| = sqrt(d' M d), and a row is divided by
// |G_i| = sqrt(J_i M^-1 J_i'). No factor of M enters a residual: d' M d needs M alone, and the dual norm
// sqrt(r' M^-1 r) of a residual r needs few digits. So M d, J z - c and M d - J' lambda are taken from the stored
// doubles in double-double arithmetic, and M is factorized (sparse, FactorReal) only for weights.
//
// Powers of two are divided out first, without rounding: one per row of J (2^row_exponent), one of M (2^mass_exponent,
// even), one common to z, z_u and c (2^motion_exponent). Rows at 2^+-500 and c at 1e300 then neither overflow nor
// vanish. All members and arguments are in these units unless they say otherwise. (contact_problem.h goes on to finer
// ones, in which each unknown is 2^column_exponent as large; here these are 0.)
class ScaledProblem {
 public:
  // O(nonzeros) and one sparse factorization. Sizes must match and entries be finite (see bad_input).
  explicit ScaledProblem(const Problem& problem);

  Index size() const { return z_u.size(); }
  Index rows() const { return c.size(); }
  bool is_equality(Index i) const { return equality[at(i)] != 0; }
  // A row that says nothing (c = -Inf, or beyond all doubles in these units), and a row of zeros, which holds by the c
  // that was stored or not at all.
  bool is_vacuous(Index i) const { return !std::isfinite(is_zero(i) ? stored_c[i] : c[i]); }
  bool is_zero(Index i) const { return row_norm[i] == 0; }
  bool counts(Index i) const { return !is_vacuous(i) && !is_zero(i); }
  bool zero_row_holds(Index i) const { return is_equality(i) ? stored_c[i] == 0 : stored_c[i] <= 0; }

  Problem problem() const;  // of these rows in these units, without friction

  // From the problem's units to these, and back.
  ExtendedVector motion(const Vector& z) const;  // d = z - z_u
  // So that M d = J' lambda stays true; 0 on rows that say nothing, which cannot push.
  ExtendedVector multipliers(const Vector& lambda) const;
  ExtendedVector motion_of(const ExtendedVector& d) const;  // of a d in the problem's units
  Vector rounded_motion(const ExtendedVector& d) const;     // z of the problem, rounded once
  ExtendedVector to_multipliers(const ExtendedVector& lambda) const;
  ExtendedVector multipliers(ExtendedVector lambda) const;
  double scale_of(double norm) const;         // s of a motion of this norm: what errors are divided by
  double least_scale() const;                 // the smallest normal number of the problem's units: s is never below it
  double to_problem_norm(double norm) const;  // kg^1/2 m/s^2
  int norm_exponent() const { return motion_exponent + mass_exponent / 2; }  // of two, from these to the problem's
  double row_scale(Index i) const;  // J z - c of the problem = row_scale * ours

  double norm(const ExtendedVector& d) const;                   // sqrt(d' M d)
  double norm_of(const Vector& z) const;                        // the same of z itself, z in the problem's units
  double norm_of_free_motion() const;                           // |z_u|_M
  double norm_with_free_motion(const ExtendedVector& d) const;  // |z_u + d|_M
  double dual_norm(const ExtendedVector& r) const;              // sqrt(r' M^-1 r)
  DoubleDouble slack(Index i, const ExtendedVector& d) const;   // J_i (z_u + d) - c_i, not divided by |G_i|
  bool slack_vanishes(Index i, const ExtendedVector& d) const;  // exactly
  double unit_slack(Index i, const ExtendedVector& d) const { return slack(i, d).hi / row_norm[i]; }
  VectorX<FactorReal> unit_row(Index i) const { return whitened_row(i) / FactorReal(row_norm[i]); }
  VectorX<FactorReal> whitened_row(Index i) const;                   // G_i, n, permuted as Q = L'P
  VectorX<FactorReal> whiten(const ExtendedVector& r) const;         // Q^-T r: |.| is the dual norm
  VectorX<FactorReal> unwhiten(const VectorX<FactorReal>& y) const;  // Q^-1 y: its M-norm is |y|
  double rounding(Index i, const ExtendedVector& d) const;  // bounds the error of slack(i, d), divided by |G_i|
  // M d - J' lambda; no lambda: M d. And what bounds its rounding: entrywise, and of its dual norm.
  ExtendedVector force_residual(const ExtendedVector& d, const ExtendedVector& lambda) const;
  Vector force_roundings(const ExtendedVector& d, const ExtendedVector& lambda) const;
  double force_rounding(const ExtendedVector& d, const ExtendedVector& lambda) const;

  using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<FactorReal>>;

  bool definite = true;  // M is proven positive definite; if not, row_norm and the dual norm mean nothing
  SparseMatrix M;
  RowMatrix J;
  Vector z_u, c, row_norm, stored_c;
  ExtendedVector h;  // c - J z_u; 0 where c is not finite
  std::vector<char> equality;
  std::shared_ptr<Factor> factor = std::make_shared<Factor>();  // of M before its unknowns are scaled
  Eigen::ArrayXi row_exponent, column_exponent;
  int mass_exponent = 0, motion_exponent = 0;

 private:
  void weigh_rows();
  bool proven_definite() const;
};

}  // namespace zwang
