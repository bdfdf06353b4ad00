#pragma once

#include <zwang/core/referee/friction/mode_system.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {

// sigma, one a contact, exact up to `error`.
struct Slips {
  ExtendedVector sigma;
  Vector error;
  explicit Slips(Index contacts) : sigma(ExtendedVector::Zero(contacts)), error(Vector::Zero(contacts)) {}
};

// A motion d near Z(sigma): the convex answer in which the cones of the contacts are lifted by mu sigma (sigma = 0: the
// convex law itself). In the units of a ContactProblem.
//
// Weak duality: for d with s~(d) in K*, s~ = s + mu sigma e_n, and any lambda with its contacts in K,
//
//   |d - Z|_M <= sqrt(2 gap),   gap = 1/2 |M d - J'lambda|^2_(M^-1) + lambda's~(d),
//
// in double-double, with margins for its rounding. Equality rows are met up to |s| / sigma_min, which is added.
struct ConvexBound : ModePoint {
  enum class Rows { open, feasible, infeasible };
  double upper = infinity;  // |x - Z|_M
  bool interior = false;    // some z meets the rows with every contact strictly inside K* (and the equality rows)
  Rows rows = Rows::open;
};

// `guess` may be null: modes and multipliers to begin with. An upper that is `enough` is not made smaller.
ConvexBound bound_convex(const ContactProblem& problem, const Slips& slips, const ModePoint* guess,
                         double enough = referee::sharp_enough);

// C, so that |Z(sigma) - Z(sigma')|^2 <= 2 C d for all slips sigma, sigma' >= 0 of motions that are d apart; infinity
// where no motion is found that brings every contact with friction to the inside of K*.
//
// With x, lambda of Z(sigma) and x', lambda' of Z(sigma'), complementarity and both cones leave
//
//   |x - x'|^2 = (lambda - lambda')'(s - s') <= sum_i mu_i |sigma_i - sigma'_i| max(lambda_n, lambda'_n)_i,
//
// |sigma_i - sigma'_i| <= |G_t,i| d, and a motion x0 that meets the equality rows with s_n - mu |s_t| >= m_i > 0 bounds
// every such lambda: sum m_i lambda_n,i <= lambda's~(x0) = x'M (x0 - x) <= |x0|^2 / 4. So C = max_i (mu_i |G_t,i| /
// m_i) |x0|^2 / 4.
double bound_turn(const ContactProblem& problem);

// Independent equality rows, exactly; `contradictory` where they cannot all hold.
std::vector<Index> independent_equalities(const ContactProblem& problem, bool& contradictory);

}  // namespace zwang
