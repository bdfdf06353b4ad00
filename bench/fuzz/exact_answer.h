#pragma once

#include <optional>

#include <zwang/core/problem/instance.h>

namespace zwang {

// The answer of a problem of small dyadic numbers in integer arithmetic, rounded once: z*, lambda* or a certificate.
//
//   find lambda_I >= 0, slack_I >= 0, lambda . slack = 0,  slack = S lambda - h   (equality rows: slack = 0)
//
// by principal pivoting with the least-index criss-cross rule (Klafszky & Terlaky 1992; Fukuda & Terlaky 1992), which
// ends on every positive semidefinite S, on a tableau of integers over one denominator (Bareiss 1968: each division
// leaves no remainder). No tolerance anywhere, and no code shared with a solver. Empty where a number of the problem is
// not an integer / 2^10, or larger than 2^40.
std::optional<Reference> exact_answer(const Problem& problem);

}  // namespace zwang
