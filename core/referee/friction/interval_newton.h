#pragma once

#include <limits>
#include <string_view>

#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// A solution of Coulomb's law that was proven to exist, in the units of a ContactProblem.
//
// Krawczyk's operator (1969) on the equations of the modes (mode_system.h), residuals in double-double with bounds on
// their rounding: the box x +- radius_x holds a zero. Where rows depend on each other, an independent part is imposed
// and the other multipliers keep their values; that the rows left out hold is decided in integers modulo primes, and so
// is an inequality of the modes that holds with equality. What was not shown to hold is bounded by `delta`: then the
// point solves a problem whose c (of unit rows) or z_u (for forces outside their cone) differs by delta s, and need not
// be near a solution of this one.
struct ModeProof {
  bool proven = false;
  ModePoint point = {};
  double radius = infinity;  // |z - z_point|_M / s
  double delta = infinity;
  bool strict = false;         // every inequality of the modes holds on the whole box with something to spare
  double null_motion = 0;      // largest |dz|_M of a unit change of multipliers that keeps the equations
  bool unique_forces = false;  // no multipliers are free to change
  std::string_view by = "interval Newton";
  bool continuum = false;  // proven: strict, delta = 0, and z moves as multipliers that are free to change do
};

// Proves a solution near a guess: polished first, and with the modes changed that do not hold, as long as that takes
// less than referee::searched_products. work: what it took is added.
ModeProof prove_near(const ContactProblem& problem, const ScaledProblem& scaled, ModePoint guess,
                     double* work = nullptr);

}  // namespace zwang
