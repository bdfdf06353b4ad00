#pragma once

#include <span>
#include <vector>

#include <zwang/core/referee/friction/mode_system.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {

// An answer on the way: strictly inside both cones up to the residual that is left.
struct InteriorAnswer : ModePoint {   // modes: by the eigenvalues of both sides
  double complementarity = infinity;  // mean of lambda's~ over the contacts
  double residual = infinity;
};

struct InteriorOptions {
  double start = 1;                          // size of the first iterate, of the motion
  double target = referee::interior_target;  // of the complementarity
  double inward = 0;  // every cone is moved in by so much of the motion: answers are strictly inside the true ones
};

// Primal-dual interior point on the cones y = (mu l_n, l_t) and w = (s_n / mu + |s_t|, s_t), with Nesterov-Todd scaling
// P and Mehrotra's steps. Under Coulomb's law (sigma = null) |s_t| is differentiated; otherwise sigma, one a contact,
// stands in its place, and the problem is convex. equalities: independent equality rows E. All iterates, the last the
// best.
//
// The steps solve [[M + C'P^2 T C, E'], [E, 0]], C the contacts' rows and T the turn of the slips: as large as the
// motion and the equality rows, and regular however contacts depend on each other. (W + P^-2 in the rows, W = C M^-1
// C', is not: where redundant rows disagree in their last digits, it does not show which of them hold.) Residuals are
// in double-double. Real: double, or with slips DoubleDouble, whose factor is Cholesky's of ExtendedSymmetric.
// O(unknowns^3) an iteration.
template <class Real>
std::vector<InteriorAnswer> interior_point(const ContactProblem& problem, std::span<const Index> equalities,
                                           const ExtendedVector* sigma, const InteriorOptions& options = {});

}  // namespace zwang
