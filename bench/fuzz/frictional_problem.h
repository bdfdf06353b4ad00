#pragma once

#include <zwang/core/problem/instance.h>

namespace zwang {

// Problem number `number` of a fuzzing run with friction, under Coulomb's law. Of ten, four are planar with up to four
// contacts and entries -1, 0, 1, which enumeration decides (references/friction/exact_solutions.h); three are of
// that kind with two tangents a contact; three have a planted answer, whose contacts then rest without force, stand
// on the cone's edge, are repeated or have very different masses. Repeated and opposed contacts, tangents of zeros and
// mu = 0 are the rule. Dyadic, and the same on every machine.
Problem frictional_problem(std::uint64_t seed, std::uint64_t number);

// One of the last kind, small enough for rationals, under the convex law or Coulomb's: z and lambda are its reference,
// without rounding. mu is mostly small, so that there is no other solution.
Instance planted_problem(std::uint64_t seed, std::uint64_t number, Law law);

}  // namespace zwang
