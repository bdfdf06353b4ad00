#pragma once

#include <functional>
#include <span>
#include <string>

#include <zwang/core/problem/solver.h>

namespace zwang {

// How a check ended. `off` is the largest distance of what was computed from what is exact, in the check's own units
// (m/s, m, steps); NaN where the solver gave no answer.
struct ConformanceResult {
  double off = 0;
  std::string note = {};  // what the solver said where it gave no answer
  bool applies = true;    // false: the solver does not take such problems

  bool passes(double tolerance) const { return off <= tolerance; }
};

// Anything that solves a problem under the law that it states.
using ConformanceSolve = std::function<Solution(const Problem&)>;

// A phenomenon with an exact answer under Coulomb's law: one problem, or a number of implicit steps.
struct ConformanceCheck {
  std::string name;
  std::string expected;  // in words and numbers
  std::function<ConformanceResult(const ConformanceSolve&)> run;
};

std::span<const ConformanceCheck> conformance_checks();

// How far an answer may be off and pass.
inline constexpr double conformance_accepted = 1e-6;

// Of a solver that reads Coulomb's law as it is, or else another law in its place: the problems are then stated under
// the first of convex, pyramid and frictionless that it does not call unsupported, and the difference is what that law
// is off by. `stated`, where given, is that law: the nearest to Coulomb's that it answered under so far.
ConformanceSolve conformance_solve(ConformanceSolve solver, Law* stated = nullptr);

}  // namespace zwang
