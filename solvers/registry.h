#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/solver.h>
#include <zwang/solvers/common/setting.h>

namespace zwang {

struct SettingInfo {
  std::string name, help, value;  // value: the default
};

// How accurate a solver is on small problems of order 1, at the tolerance that suits it.
struct Accuracy {
  double tolerance = 1e-10;    // asked for
  double z_error = 1e-12;      // of what it claims solved, |z - z*|_M / max(|z_u|_M, |z*|_M), at most
  double certificate = 1e-12;  // |J'u| of what it claims infeasible, relative, at most
  double solved_share = 1;     // of feasible problems, at least
};

// A solver and what it can do, said once: suites, the fuzzer and the tests go by it.
struct SolverEntry {
  static constexpr Index any_size = std::numeric_limits<Index>::max();
  std::string name = {};
  std::string method = {};          // one line
  std::string limits = {};          // what it cannot do, one line
  bool foreign = false;             // may hang or crash: runs in a child process with a deadline
  bool exact = false;               // an active-set method: the answer does not depend on the tolerance
  bool sees_infeasibility = true;   // false: may claim success where no z exists
  bool needs_range = false;         // right only where c lies in range(J)
  bool needs_rank = false;          // may give up, saying so, on dependent equality rows
  bool creeps = false;              // goes to its iteration limit on degenerate rows
  bool yardstick = false;           // the speed suite never shortens its time limit
  Index largest_island = any_size;  // unknowns; the speed suite asks no more of its dense matrices
  Accuracy accuracy = {};
  std::vector<SettingInfo> settings = {};
  // Builds the solver with `key=value,...` applied; throws std::invalid_argument naming the setting.
  std::function<AnySolver(std::string_view settings)> make = {};
};

// Every solver there is, in the order of `./zwang solvers`. Explicit: a new solver is one line in registry.cpp.
std::span<const SolverEntry> solvers();

// By its name, which may be followed by ":key=value,...". Null when there is none. `among`: a test may bring solvers of
// its own.
const SolverEntry* find_solver(std::string_view text, std::span<const SolverEntry> among = solvers());

// "nnls" or "nnls:key=value,..." -> solver. Throws std::invalid_argument with the nearest name.
AnySolver make_solver(std::string_view text, std::span<const SolverEntry> among = solvers());

}  // namespace zwang
