#pragma once

#include <vector>

#include <zwang/core/referee/scaled_problem.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {

// One contact: its inequality row and the tangent rows after it.
struct ContactRows {
  Index row = 0;
  Index tangents = 0;  // rows stored; they count only where mu > 0
  double mu = 0;
  double unit = 1;  // g = |G_n|, or the largest |G_t| where G_n = 0; 0 where nothing can move the contact

  Index rows() const { return mu > 0 ? 1 + tangents : 1; }  // of its cone
};

// A frictional problem for proofs: M x = J'lambda, s = J x - h, in units in which the diagonal of M, the unit g of each
// contact and the scale of the motion lie near 1: of an unknown, of each contact's rows and of the motion powers of two
// are divided out once more. The scaling is exact, and so are M and J; only h is rounded, to double-double. Contacts
// that say nothing (c_n = -Inf) are left out, and so are rows of zeros: they are in `fixed`.
class ContactProblem : public ScaledProblem {
 public:
  // `motion_scale`: s in the units of `scaled`, which is of this problem.
  ContactProblem(const Problem& problem, const ScaledProblem& scaled, double motion_scale);

  // What is left out pushes nothing: its multipliers are 0.
  ExtendedVector multipliers(const Vector& lambda) const;

  double slack_error(Index row, const ExtendedVector& x) const;                  // bounds the rounding of slack()
  double reach(Index row, const Vector& radius) const;                           // |J_row| radius
  void add_push(Index row, double most, Vector& force) const;                    // force += |J_row|' most
  DoubleDouble slip(const ContactRows& contact, const ExtendedVector& x) const;  // |s_t|
  double slip_error(const ContactRows& contact, const ExtendedVector& x) const;
  Vector force_error(const ExtendedVector& x, const ExtendedVector& lambda) const;  // bounds its rounding, entrywise
  double norm(const ExtendedVector& x) const;                                       // sqrt(x'M x)
  double norm_bound(const Vector& radius) const;                                    // of every |x_j| <= radius_j
  double dual_norm(const Vector& bound) const;  // of every |r_j| <= bound_j; 0 for 0
  double dual_norm(const ExtendedVector& r) const { return referee::up(ScaledProblem::dual_norm(r)); }

  ExtendedVector motion_by(const ExtendedVector& lambda, int rounds = 3) const;  // M^-1 J'lambda, refined

  bool exact = true;                 // no power of two under- or overflowed in M, J and h
  bool keeps_motion = true;          // nor made an entry of z_u vanish
  bool fixed_contradiction = false;  // a row of zeros that cannot hold
  Vector h_error;
  std::vector<ContactRows> contacts;
  std::vector<Index> equalities;
  double scale = 1;  // s: between 1/2 and 1

 private:
  mutable Vector unit_norm_;  // of the entries of a force
};

}  // namespace zwang
