#pragma once

#include <vector>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// A part of a problem that shares no row and no entry of M with the rest, in the units of the scaled problem it was cut
// from; apart from Islands, which solvers use.
struct IslandPart {
  Problem problem = {};
  std::vector<Index> columns = {}, rows = {};

  ExtendedVector columns_of(const ExtendedVector& x) const { return pick(columns, x); }
  ExtendedVector rows_of(const ExtendedVector& x) const { return pick(rows, x); }

 private:
  static ExtendedVector pick(const std::vector<Index>& places, const ExtendedVector& x) {
    ExtendedVector out;
    out.reserve(places.size());
    for (const Index i : places) out.push_back(x[static_cast<std::size_t>(i)]);
    return out;
  }
};

// Rows of zeros and rows with c = -Inf belong to no part.
std::vector<IslandPart> split_islands(const ScaledProblem& scaled);

}  // namespace zwang
