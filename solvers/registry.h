#pragma once

#include <span>
#include <string_view>

#include <zwang/solvers/solver_entry.h>

namespace zwang {

// Every solver there is, in the order of `./zwang solvers`. Explicit: a new solver is one line in registry.cpp.
std::span<const SolverEntry> solvers();

// One more, of a host program: behind the others. Before the first run: spans of solvers() taken earlier are void then.
// Throws std::invalid_argument where its name is taken.
void add_solver(SolverEntry entry);

// An optional solver whose library was absent when this was built.
struct AbsentSolver {
  std::string_view name, how_to_add;
};
std::span<const AbsentSolver> absent_solvers();

// By its name, which may be followed by ":key=value,...". Null when there is none. `among`: a test may bring solvers of
// its own.
const SolverEntry* find_solver(std::string_view text, std::span<const SolverEntry> among = solvers());

// "nnls" or "nnls:key=value,..." -> solver. Throws std::invalid_argument with the nearest name,
// or with how to add one that is absent.
AnySolver make_solver(std::string_view text, std::span<const SolverEntry> among = solvers());

// The solver to begin with, by the table of docs/performance.md: cone where there is friction; newton where more than a
// thousand rows of contacts and limits hang together, for it is sparse; else dual_active_set.
std::string_view usual_solver(const Problem& problem);

// Does it run in a child process? As its entry says, or that of the solver that it is to use (inner=NAME).
bool runs_apart(std::string_view text, std::span<const SolverEntry> among = solvers());

}  // namespace zwang
