#pragma once

#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// A part of a problem that shares no entry of M, no row and no contact with the rest, in the problem's units; apart
// from Islands, which solvers use.
struct IslandPart {
  Problem problem = {};
  std::vector<Index> columns = {}, rows = {};  // of the whole, ascending
};

// A contact stays in one part, its rows of zeros too. All unknowns that no row meets are one part. Contacts and
// equality rows that meet no unknown are in the first part, and those that say nothing (c = -Inf) in none. Empty where
// the problem is one part.
std::vector<IslandPart> split_islands(const Problem& problem);

}  // namespace zwang
