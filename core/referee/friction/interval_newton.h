#pragma once

#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// Proves a solution near a guess: polished first, and with the modes changed that do not hold, as long as that takes
// less than referee::searched_products. work: what it took is added.
//
// Krawczyk's operator (1969) on the equations of the modes (mode_system.h), residuals in double-double with bounds on
// their rounding: the box x +- radius_x holds a zero. Where rows depend on each other, an independent part is imposed
// and the other multipliers keep their values; that the rows left out hold is decided in integers modulo primes, and so
// is an inequality of the modes that holds with equality. What was not shown to hold is bounded by `delta`: then the
// point solves a problem whose c (of unit rows) or z_u (for forces outside their cone) differs by delta s, and need not
// be near a solution of this one.
ModeProof prove_near(const ContactProblem& problem, ModePoint guess, double* work = nullptr);

}  // namespace zwang
