#pragma once

#include <functional>
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

// One line of `./zwang solvers`.
struct SolverEntry {
  std::string name;
  std::string method;    // one line
  std::string limits;    // what it cannot do, one line
  bool foreign = false;  // may hang or crash: runs in a child process with a deadline
  bool exact = false;    // an active-set method: the answer does not depend on the tolerance
  std::vector<SettingInfo> settings = {};
  // Builds the solver with `key=value,...` applied; throws std::invalid_argument naming the setting.
  std::function<AnySolver(std::string_view settings)> make;
};

// Every solver there is, in the order of `./zwang solvers`. Explicit: a new solver is one line in registry.cpp.
std::span<const SolverEntry> solvers();

// Null when there is none of that name. `among`: a test may bring solvers of its own.
const SolverEntry* find_solver(std::string_view name, std::span<const SolverEntry> among = solvers());

// "nnls" or "nnls:key=value,..." -> solver. Throws std::invalid_argument with the nearest name.
AnySolver make_solver(std::string_view text, std::span<const SolverEntry> among = solvers());

}  // namespace zwang
