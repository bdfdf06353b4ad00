#pragma once

#include <zwang/core/problem/problem.h>

namespace zwang {

// Problem number `number` of a run over near-dependent rows: up to 14 unknowns, masses of 2^-20 to 2^20, coupled or
// not, and rows that are mostly copies, multiples and sums of earlier ones, off by 2^-22 to 2^-50 of them, copies of
// copies too; c fits one motion exactly, or contradicts it by 2^-20 to 2^-40, or is drawn at random. Dyadic, but not
// short: only 100 digits tell the truth. The same on every machine.
Problem near_problem(std::uint64_t seed, std::uint64_t number, Index most_unknowns = 14);

}  // namespace zwang
