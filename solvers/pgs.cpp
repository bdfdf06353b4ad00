#include "solvers/pgs.h"

#include "solvers/farkas.h"
#include "solvers/kkt_check.h"
#include "solvers/stop.h"

namespace zwang {

std::vector<Setting<Pgs>> Pgs::settings() {
  return {{"relaxation", &Pgs::relaxation, "step on each row as a share of the exact one, 0 < relaxation < 2"},
          {"max_sweeps", &Pgs::max_sweeps, "sweeps over all rows before giving up"}};
}

void Pgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  auto& [program, lambda, y, before, marked, drift, motion] = work;
  if (!program.build(problem, options, solution)) return;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, y);
  marked.setZero(program.rows());
  Contraction contraction;
  const int limit = std::min(max_sweeps, options.max_iterations);
  solution.status = Status::iteration_limit;

  for (int sweep = 0;; ++sweep) {
    // On a problem without a solution lambda runs off along a Farkas vector, while y settles.
    const bool power_of_two = sweep >= 16 && (sweep & (sweep - 1)) == 0;
    if (power_of_two) {
      drift = lambda - marked;
      if (proves_infeasible(program, drift, motion)) {
        solution.status = Status::infeasible;
        sharpen(program, drift);
        program.write_certificate(problem, drift, solution);
        break;
      }
      marked = lambda;
    }
    if (sweep == limit) break;
    if (deadline.passed()) {
      solution.status = Status::time_limit;
      break;
    }

    before = y;
    double largest = 0;
    for (Index i = 0; i < program.rows(); ++i) {
      double updated = lambda[i] + relaxation * (program.h()[i] - program.dot(i, y));
      if (!program.is_equality(i)) updated = std::max(0.0, updated);
      const double step = updated - lambda[i];
      largest = std::max(largest, std::abs(step));
      lambda[i] = updated;
      if (step != 0) program.add(i, step, y);
    }
    solution.iterations = sweep + 1;
    contraction.record((y - before).norm());
    if (options.observe) {
      program.write(problem, y, lambda, solution);
      options.observe(solution.iterations, solution.z, solution.lambda);
    }

    const double scale = program.scale(y), tolerance = options.tolerance * scale;
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
    if (largest <= tolerance && contraction.distance_to_go(rounding * scale) <= tolerance) {
      program.motion(lambda, y);
      if (natural_residual(program, y, lambda) <= options.tolerance) {
        solution.status = Status::solved;
        break;
      }
    }
  }
  program.motion(lambda, y);
  program.write(problem, y, lambda, solution);
}

}  // namespace zwang
