#pragma once

#include <zwang/core/problem/types.h>

namespace zwang::referee {

// What the referee knows of the laws of cones, apart from what solvers go by (core/problem/law.h): does slip lift the
// normal row, K* ∋ s + mu |s_t| e_n ⊥ lambda ∈ K? Elsewhere K* ∋ s ⊥ lambda ∈ K, which has one z at most.
constexpr bool slip_lifts(Law law) { return law == Law::coulomb; }

}  // namespace zwang::referee
