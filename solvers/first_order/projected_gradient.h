#pragma once

#include <zwang/solvers/first_order/dual_iteration.h>
#include <zwang/solvers/first_order/stop.h>

namespace zwang {

// Minimizes 1/2 |G' lambda|^2 - h' lambda over lambda_I >= 0, in steps of 1 / trace(G G') = 1 / rows.
struct ProjectedGradient {
  static constexpr auto name = "projected_gradient";
  DualIteration iteration = {};
  Vector slack = {}, before = {};

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    if (!iteration.begin(problem, options, solution)) return;
    UnitProgram& program = iteration.program;
    Vector &lambda = iteration.lambda, &y = iteration.y;
    const Deadline deadline(options.time_limit);
    LinearConvergenceEstimate steps;
    for (int& step = solution.iterations; step < options.max_iterations && step < 20000; ++step) {
      if (deadline.passed()) solution.status = Status::time_limit;
      if (solution.status != Status::iteration_limit) break;
      program.slack(y, slack);
      program.project(lambda -= slack / double(program.rows()));
      before = y;
      program.motion(lambda, y);
      steps.record((y - before).norm());
      if (steps.distance_to_go(1e-15 * program.scale(y)) > options.tolerance * program.scale(y)) continue;
      if (program.natural_residual(y, lambda) <= options.tolerance) solution.status = Status::solved;
    }
    iteration.end();
  }
};

}  // namespace zwang
