#include <zwang/solvers/first_order/pgs.h>

#include <zwang/solvers/first_order/stop.h>

namespace zwang {

void Pgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (!iteration.begin(problem, options, solution)) return;
  UnitProgram& program = iteration.program;
  Vector &lambda = iteration.lambda, &y = iteration.y;
  LinearConvergenceEstimate contraction;
  while (iteration.goes_on(max_sweeps)) {
    before = y;
    double largest = 0;
    for (Index i = 0; i < program.rows(); ++i) {
      double updated = lambda[i] + relaxation * (program.h[i] - program.dot(i, y));
      if (!program.is_equality(i)) updated = std::max(0.0, updated);
      const double step = updated - lambda[i];
      largest = std::max(largest, std::abs(step));
      lambda[i] = updated;
      if (step != 0) program.add(i, step, y);
    }
    contraction.record((y - before).norm());
    const double scale = program.scale(y), tolerance = options.tolerance * scale;
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
    const bool asks = options.has_accuracy() && scale > 0;
    if (iteration.step_done(asks ? contraction.distance_to_go(rounding * scale) / scale : infinity)) return;

    if (largest <= tolerance && contraction.distance_to_go(rounding * scale) <= tolerance) {
      program.motion(lambda, y);
      if (program.natural_residual(y, lambda) <= options.tolerance) {
        solution.status = Status::solved;
        break;
      }
    }
  }
  program.motion(lambda, y);
  iteration.end();
}

}  // namespace zwang
