#pragma once

#include <zwang/core/problem/instance.h>

namespace zwang {

// Puts a known answer on the structure (M, J, kind) of a problem: draws z*, lambda* and which inequality rows push
// (each with probability active_fraction), and replaces c and z_u so that they are the solution. The reference's method
// is "known answer". Its bound is proven for the stored doubles: c = J z* holds exactly on every row that pushes, and
// an error in z_u moves the solution by no more than itself in the M-norm, measured in double-double arithmetic. M must
// be positive definite.
Instance with_known_answer(Instance instance, std::uint64_t seed, double active_fraction);

}  // namespace zwang
