#pragma once

#include "solvers/kkt_check.h"
#include "solvers/stop.h"

namespace zwang {

// Minimizes 1/2 |G' lambda|^2 - h' lambda over lambda_I >= 0, in steps of 1 / trace(G G') = 1 / rows.
struct ProjectedGradient {
  static constexpr auto name = "projected_gradient";
  UnitProgram program = {};
  Vector lambda = {}, slack = {}, y = {}, before = {};

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    if (!program.build(problem, solution)) return;
    solution.reset(problem.size(), problem.rows());
    program.warm_multipliers(problem, options.warm_start, lambda);
    program.motion(lambda, y);
    Contraction contraction;
    int& step = solution.iterations;
    for (solution.status = Status::iteration_limit; step < std::min(options.max_iterations, 20000); ++step) {
      program.slack(y, slack);
      lambda -= slack / double(program.rows());
      program.project(lambda);
      before = y;
      program.motion(lambda, y);
      contraction.record((y - before).norm());
      if (contraction.distance_to_go(1e-15 * program.scale(y)) > options.tolerance * program.scale(y)) continue;
      if (natural_residual(program, y, lambda) <= options.tolerance) solution.status = Status::solved;
      if (solution.status == Status::solved) break;
    }
    program.write(problem, y, lambda, solution);
  }
};

}  // namespace zwang
