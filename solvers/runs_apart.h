#pragma once

#include <span>
#include <string_view>

#include <zwang/solvers/registry.h>

namespace zwang {

// Does this solver run in a child process? As its entry says, or that of the solver that it is to use (inner=NAME).
bool runs_apart(std::string_view text, std::span<const SolverEntry> among = solvers());

}  // namespace zwang
