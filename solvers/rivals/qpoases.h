#pragma once

#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/common/unit_program.h>

namespace zwang {

// qpOASES (Ferreau, Kirches, Potschka, Bock & Diehl 2014, "qpOASES: a parametric active-set algorithm for quadratic
// programming"; 3.2), dense, with its own MPC options (`mpc`), which are several times faster here than its default and
// as right. T is its termination tolerance; its word is claimed as it is. It gives no dual ray. One iteration is one
// change of its working set. Warm starts pass the multipliers.
struct Qpoases {
  static constexpr auto name = "qpoases";
  static constexpr Index most_unknowns = 1000, most_rows = 2000;  // its matrices are dense

  bool mpc = true;
  int max_iterations = 100000;

  static std::vector<Setting<Qpoases>> settings() {
    return {{"mpc", &Qpoases::mpc, "qpOASES' options for model predictive control; off: its default options"},
            {"max_iterations", &Qpoases::max_iterations, "changes of the working set before giving up"}};
  }
  std::string supports(const Problem& problem) const;
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  struct Workspace {
    UnitProgram program;
    Matrix Gt;  // n x k
  };
  Workspace work = {};
};

static_assert(Solver<Qpoases>);

}  // namespace zwang
