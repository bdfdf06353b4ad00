#pragma once

#include <string_view>

#include <zwang/core/problem/problem.h>

namespace zwang {

// The solver to begin with, by the table of docs/performance.md: cone where there is friction; newton where more than a
// thousand rows of contacts and limits hang together, for it is sparse; else dual_active_set.
std::string_view usual_solver(const Problem& problem);

}  // namespace zwang
