#pragma once

#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/friction/mode_newton.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Semismooth Newton on Alart and Curnier's equations from the start (1991, Comput. Methods Appl. Mech. Eng. 92),
// without the interior point that `cone` puts before it: whole steps, the modes chosen anew at each. One iteration is
// one factorization.
struct AlartCurnier {
  static constexpr std::string_view name = "alart_curnier";
  static constexpr auto laws = laws_that<has_cones>;
  static constexpr bool needs_friction = true;

  int max_steps = 200;

  static std::vector<Setting<AlartCurnier>> settings() {
    return {{"max_steps", &AlartCurnier::max_steps, "Newton steps before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    if (!iteration.begin(problem, options, solution)) return;
    modes.begin(iteration.program, iteration.v, iteration.y);
    while (iteration.goes_on(max_steps)) {
      if (!modes.step(iteration.program)) {
        solution.status = Status::numerical_failure;
        solution.message = "the matrix of the modes breaks down";
        break;
      }
      iteration.v = modes.v;
      iteration.y = modes.y;
      if (iteration.step_done()) break;
    }
    iteration.end();
  }

  ConeIteration iteration = {};
  ModeNewton modes = {};
};
static_assert(Solver<AlartCurnier>);

}  // namespace zwang
