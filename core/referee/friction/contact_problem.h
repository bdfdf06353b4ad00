#pragma once

#include <vector>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// One contact: its inequality row and the tangent rows after it.
struct ContactRows {
  Index row = 0;
  Index tangents = 0;  // rows stored; they count only where mu > 0
  double mu = 0;
  double unit = 1;  // g = |G_n|, or the largest |G_t| where G_n = 0; 0 where nothing can move the contact

  Index rows() const { return mu > 0 ? 1 + tangents : 1; }  // of its cone
};

// A frictional problem for proofs: M x = J'lambda, s = J x - h, with powers of two divided out so that the diagonal of
// M, the unit g of every contact and the scale of the motion lie near 1. The scaling is exact, and so are M and J; only
// h is rounded, to double-double. Contacts that say nothing (c_n = -Inf) are left out, and so are rows of zeros: they
// are in `fixed`.
class ContactProblem {
 public:
  // `motion_scale`: s in the scaled problem's units. J and M as in `scaled`, which must stay.
  ContactProblem(const Problem& problem, const ScaledProblem& scaled, double motion_scale);

  Index size() const { return M.cols(); }
  Index rows() const { return J.rows(); }

  const ScaledProblem& scaled() const { return *scaled_; }

  // From the problem's units, and back. What is left out pushes nothing: its multipliers are 0.
  ExtendedVector motion(const Vector& z) const;  // z - z_u
  ExtendedVector multipliers(const Vector& lambda) const;
  Vector rounded_motion(const ExtendedVector& x) const;  // z, rounded once
  ExtendedVector to_multipliers(const ExtendedVector& lambda) const;
  int block_exponent(Index row) const;                                      // the problem's row is 2^e of ours
  double from_norm(double norm) const { return std::ldexp(norm, -shift); }  // an M-norm of scaled()

  double length(const ExtendedVector& x) const;  // |z_u + x|_M
  double least_motion(double length) const;      // what errors are divided by, where |z|_M is at least `length`

  DoubleDouble slack(Index row, const ExtendedVector& x) const;
  double slack_error(Index row, const ExtendedVector& x) const;                  // bounds the rounding of slack()
  double reach(Index row, const Vector& radius) const;                           // |J_row| radius
  void add_push(Index row, double most, Vector& force) const;                    // force += |J_row|' most
  DoubleDouble slip(const ContactRows& contact, const ExtendedVector& x) const;  // |s_t|
  double slip_error(const ContactRows& contact, const ExtendedVector& x) const;
  ExtendedVector force_residual(const ExtendedVector& x, const ExtendedVector& lambda) const;  // M x - J'lambda
  Vector force_error(const ExtendedVector& x, const ExtendedVector& lambda) const;  // bounds its rounding, entrywise
  double norm(const ExtendedVector& x) const;                                       // sqrt(x'M x)
  double norm_bound(const Vector& radius) const;                                    // of every |x_j| <= radius_j
  double dual_norm(const Vector& bound) const;  // of every |r_j| <= bound_j; 0 for 0
  double dual_norm(const ExtendedVector& r) const;

  VectorX<FactorReal> whitened_row(Index row) const;                             // Q^-T J_row, M = Q'Q
  ExtendedVector motion_by(const ExtendedVector& lambda, int rounds = 3) const;  // M^-1 J'lambda, refined

  bool exact = true;                 // no power of two under- or overflowed
  bool fixed_contradiction = false;  // a row of zeros that cannot hold
  SparseMatrix M;
  RowMatrix J;
  ExtendedVector h;
  Vector h_error;
  Vector z_u, c;    // J (z_u + x) = c, as stored: without rounding, save where a power of two over- or underflowed
  Vector row_norm;  // |G_i|
  std::vector<ContactRows> contacts;
  std::vector<Index> equalities;
  double free_motion = 0;  // |z_u|_M
  double scale = 1;        // s: between 1/2 and 1

 private:
  const ScaledProblem* scaled_;
  mutable Vector unit_norm_;  // of the entries of a force
  Eigen::ArrayXi column_shift_, row_shift_;
  int shift = 0;
};

}  // namespace zwang
