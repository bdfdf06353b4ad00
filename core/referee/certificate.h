#pragma once

#include <limits>
#include <vector>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// What a vector u with u_I >= 0 proves. Any feasible z has h'u <= y'(G'u) <= |G'u| |z - z_u|_M, so every feasible
// |z - z_u|_M is at least `distance` = h'u / |G'u|, whatever u is; G'u = 0 with h'u > 0: there is none.
struct Farkas {
  double distance = std::numeric_limits<double>::quiet_NaN();  // in scaled units; NaN: no certificate
  bool proven = false;                                         // distance >= 1e8 max(s, max |h_i| / |G_i|)
  std::vector<Index> conflicting = {};                         // rows with a part in u, largest |u_i| |G_i| first
};

// Judges a certificate in double-double arithmetic: u as it was given, and u moved (by rounding, 1e-16 relative) onto
// the null space of the rows it uses, because a vector of doubles cannot have |G'u| below 1e-16 |u|. The better of the
// two counts: each is a valid u of its own. `motion_scale` is s. u: m multipliers in the problem's units.
// `cones`: a problem with tangent rows. Under the convex law u is moved into the cones K of its contacts, under
// Coulomb's only its part on normal and equality rows counts.
Farkas judge_certificate(const ScaledProblem& scaled, const Vector& certificate, double motion_scale,
                         const Problem* cones = nullptr);

}  // namespace zwang
