#pragma once

#include <span>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

enum class Consistency { consistent, contradictory, independent };

// Are the rows `more` of J z = c combinations of the rows `basis` (known to be independent), right-hand sides included?
// The stored doubles are integers times powers of two, so the question has an exact answer; it is found by elimination
// modulo two primes of 61 bits. `contradictory`: combinations on the left but not on the right, so no z meets them all.
// `independent`: not even on the left. The odds that a prime divides the deciding minor are below 1e-13 for each, and
// an answer other than `consistent` from either prime stands. O((basis + more) basis columns) modular products.
Consistency exact_consistency(const ScaledProblem& gauge, std::span<const Index> basis, std::span<const Index> more);

}  // namespace zwang
