#pragma once

#include <string>
#include <vector>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/core/problem/problem.h>

namespace zwang {

// A seed for each problem: neighbours share nothing (splitmix64, Steele et al. 2014).
std::uint64_t mix_bits(std::uint64_t seed, std::uint64_t number);

// L D L' with up to `most` units in a few places below the diagonal of L. D: the masses of D.size() unknowns.
Matrix coupled_mass(const Vector& D, int most, Draw& draw);

struct DrawnRow {
  Vector J;
  double c;
};
const DrawnRow& any_of(const std::vector<DrawnRow>& rows, Draw& draw);
// Puts the rows into the problem, equalities first.
void set_rows(Problem& problem, const std::vector<DrawnRow>& rows, Index equalities);

// Problem number `number` of a fuzzing run: up to six unknowns and ten rows with entries -1, 0, 1, where ties,
// degenerate vertices, rows without entries, repeated, opposed, doubled and summed rows, and contradictions are the
// rule. The same on every machine.
Problem small_problem(std::uint64_t seed, std::uint64_t number, int most_unknowns = 6, int most_rows = 10);

// Problem number `number` of a run over near-dependent rows: up to 14 unknowns, masses of 2^-20 to 2^20, coupled or
// not, and rows that are mostly copies, multiples and sums of earlier ones, off by 2^-22 to 2^-50 of them, copies of
// copies too; c fits one motion exactly, or contradicts it by 2^-20 to 2^-40, or is drawn at random. Dyadic, but not
// short: only 100 digits tell the truth. The same on every machine.
Problem near_problem(std::uint64_t seed, std::uint64_t number, Index most_unknowns = 14);

// One entry of M, z_u, J or c replaced by NaN, Inf, -Inf, a denormal number, 1e300 or -1e300.
struct Spoilt {
  Problem problem = {};
  bool bad = false;       // it has to be refused
  std::string what = {};  // "J(2, 0) = nan"
};
Spoilt spoil(Problem problem, std::uint64_t seed);

}  // namespace zwang
