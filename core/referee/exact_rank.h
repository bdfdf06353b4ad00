#pragma once

#include <span>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// Rank questions about rows of J z = c. The stored doubles are integers times powers of two, so these questions have
// exact answers; they are found by elimination modulo two primes of 61 bits, drawn at random by each process. Rows
// found independent are independent. The odds that a prime divides the deciding minor of others are below 1e-13 for
// each. O(rows rank columns) modular products.

enum class Consistency { consistent, contradictory, independent };

// Are the rows `more` combinations of the rows `basis` (known to be independent), right-hand sides included?
// `contradictory`: combinations on the left but not on the right, so no z meets them all. `independent`: not even on
// the left. An answer other than `consistent` from either prime stands.
Consistency exact_consistency(const RowMatrix& J, const Vector& c, std::span<const Index> basis,
                              std::span<const Index> more);

// The rows that are independent of the rows before them, and those that contradict the rows before them.
struct ExactBasis {
  std::vector<Index> rows = {}, contradictory = {};
};
ExactBasis exact_basis(const RowMatrix& J, const Vector& c, std::span<const Index> rows);

}  // namespace zwang
