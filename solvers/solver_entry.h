#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <zwang/solvers/prover.h>
#include <zwang/solvers/session.h>
#include <zwang/solvers/setting.h>

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
  std::string method = {};           // one line
  std::string limits = {};           // what it cannot do, one line
  bool foreign = false;              // may hang or crash: runs in a child process with a deadline
  bool exact = false;                // an active-set method: the answer does not depend on the tolerance
  bool sees_infeasibility = true;    // false: may claim success where no z exists
  bool proves_infeasibility = true;  // false: its "infeasible" may come without a certificate
  bool needs_range = false;          // right only where c lies in range(J)
  bool needs_rank = false;           // may give up, saying so, on dependent equality rows
  bool creeps = false;               // goes to its iteration limit on degenerate rows
  bool yardstick = false;            // the speed suite never shortens its time limit
  Index largest_island = any_size;   // unknowns; the speed suite asks no more of its dense matrices
  Accuracy accuracy = {};
  std::vector<Law> laws = {};  // under which it reads tangent rows; none: problems without them only
  bool reads(Law law) const { return std::ranges::find(laws, law) != laws.end(); }
  bool reads(const Problem& problem) const { return !problem.has_tangents() || reads(problem.law); }
  std::vector<SettingInfo> settings = {};
  // Builds the solver with `key=value,...` applied; throws std::invalid_argument naming the setting.
  std::function<AnySolver(std::string_view settings)> make = {};
};

// "key=value,..." one by one: set(k, value) is called with the place of the key in `known`, and throws
// std::invalid_argument with what it expects of the value ("a number").
void read_settings(std::string_view solver, std::string_view text, std::span<const SettingInfo> known,
                   const std::function<void(std::size_t k, const std::string& value)>& set);

// A setting of one solver: its value as text, and set from text. The latter throws std::invalid_argument with what was
// expected.
using SettingValue = std::variant<double*, int*, bool*, std::string*>;
std::string text_of(SettingValue value);
void set_from(const std::string& text, SettingValue value);
template <class S>
SettingValue value_in(S& solver, const Setting<S>& setting) {
  return std::visit([&](auto member) -> SettingValue { return &(solver.*member); }, setting.member);
}

// "" or what the problem has more of than a solver takes, whose matrices are dense.
std::string too_large(const Problem& problem, Index most_unknowns, Index most_rows);
class Promise;
Prover& prover_in(Session<Promise>& kept);  // beside Promise

// What the registry adds to a solver: its `most_unknowns`, `most_rows`, `needs_friction`, where stated, and the bound.
template <Solver S>
struct Registered : S {
  std::string supports(const Problem& problem) const {
    Index most_unknowns = SolverEntry::any_size, most_rows = most_unknowns;
    if constexpr (requires { S::most_unknowns; }) most_unknowns = S::most_unknowns;
    if constexpr (requires { S::most_rows; }) most_rows = S::most_rows;
    std::string reason = too_large(problem, most_unknowns, most_rows);
    if constexpr (requires { S::needs_friction; })
      if (reason.empty() && !problem.has_tangents()) reason = "no contact with friction";
    if constexpr (requires(const S& s) { s.supports(problem); })
      if (reason.empty()) reason = S::supports(problem);
    return reason;
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    if (!options.has_accuracy()) return S::solve(problem, options, solution);
    SolveOptions asked = options;
    asked.prover = &prover_in(promise);
    S::solve(problem, asked, solution);
    asked.prover->end(problem, options, solution);
  }

  Session<Promise> promise = {};
};

// The entry of a solver of type S, whose name, settings and laws are read from it; each that it makes begins as
// `first`:
//
//   entry<Mine>({.method = "...", .limits = "..."})
template <Solver S>
SolverEntry entry(SolverEntry e, S first = S()) {
  e.name = S::name;
  if constexpr (requires { S::laws; }) e.laws.assign(S::laws.begin(), S::laws.end());
  if constexpr (requires { S::settings(); })
    for (const Setting<S>& s : S::settings())
      e.settings.push_back({std::string(s.name), std::string(s.help), text_of(value_in(first, s))});
  e.make = [known = e.settings, first](std::string_view text) -> AnySolver {
    S solver = first;
    read_settings(S::name, text, known, [&]([[maybe_unused]] std::size_t k, [[maybe_unused]] const std::string& value) {
      if constexpr (requires { S::settings(); }) set_from(value, value_in(solver, S::settings()[k]));
    });
    if constexpr (requires { solver.complete(); }) solver.complete();  // throws as read_settings
    return Registered<S>{std::move(solver)};
  };
  return e;
}

}  // namespace zwang
