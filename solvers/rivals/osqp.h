#pragma once

#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/common/unit_program.h>

namespace zwang {

// OSQP (Stellato, Banjac, Goulart, Bemporad & Boyd 2020, "OSQP: an operator splitting solver for quadratic programs";
// 1.0 through its C interface, sparse), operator splitting, polished. T is eps_abs, with eps_rel = 0; its word is
// claimed as it is, but not what it calls inaccurate. Its dual ray is checked, and written where it is a proof. One
// iteration is one step of the splitting. Warm starts pass lambda and G'lambda.
struct Osqp {
  static constexpr auto name = "osqp";

  bool polish = true;
  int max_iterations = 100000;

  static std::vector<Setting<Osqp>> settings() {
    return {{"polish", &Osqp::polish, "a last step on the rows that look active"},
            {"max_iterations", &Osqp::max_iterations, "steps before giving up; OSQP's own default is 4000"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  struct Workspace {
    UnitProgram program;
  };
  Workspace work = {};
};

static_assert(Solver<Osqp>);

}  // namespace zwang
