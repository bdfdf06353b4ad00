#pragma once

#include <string>

#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// A motion d near Z(sigma): the convex answer in which the cones of the contacts are lifted by mu sigma (sigma = 0: the
// convex law itself). In the units of a ContactProblem.
//
// Weak duality: for d with s~(d) in K*, s~ = s + mu sigma e_n, and any lambda with its contacts in K,
//
//   |d - Z|_M <= sqrt(2 gap),   gap = 1/2 |M d - J'lambda|^2_(M^-1) + lambda's~(d),
//
// in double-double, with margins for its rounding. Equality rows are met up to |s| / sigma_min, which is added.
struct ConvexBound {
  enum class Rows { open, feasible, infeasible };
  ExtendedVector x = {}, lambda = {};
  double upper = std::numeric_limits<double>::infinity();  // |d - Z|_M
  bool interior = false;  // some z meets the rows with every contact strictly inside K* (and the equality rows)
  Rows rows = Rows::open;
  std::vector<ContactMode> modes = {};
};

// sigma: one a contact, exact up to sigma_error. `guess` may be null: modes and multipliers to begin with.
ConvexBound bound_convex(const ContactProblem& problem, const ScaledProblem& scaled, const ExtendedVector& sigma,
                         const Vector& sigma_error, const ModePoint* guess);

// Independent equality rows, exactly; `contradictory` where they cannot all hold.
std::vector<Index> independent_equalities(const ContactProblem& problem, const ScaledProblem& scaled,
                                          bool& contradictory);

}  // namespace zwang
