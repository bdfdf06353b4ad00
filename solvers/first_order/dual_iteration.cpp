#include <zwang/solvers/first_order/dual_iteration.h>

#include <algorithm>
#include <bit>

namespace zwang {

bool DualIteration::begin(const Problem& problem, const SolveOptions& options, Solution& solution) {
  problem_ = &problem;
  options_ = &options;
  solution_ = &solution;
  deadline_ = Deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return false;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, y);
  marked_.setZero(program.rows());
  prover_ = begin_prover(problem, options);
  solution.status = Status::iteration_limit;
  return true;
}

bool DualIteration::goes_on(int limit) {
  if (runs_off()) {
    solution_->status = Status::infeasible;
    sharpening_.run(program, drift_);
    program.write_certificate(*problem_, drift_, *solution_);
    return false;
  }
  if (solution_->iterations >= std::min(limit, options_->max_iterations)) return false;
  if (deadline_.passed()) solution_->status = Status::time_limit;
  return solution_->status == Status::iteration_limit;
}

// On a problem without a solution lambda runs off along a Farkas vector, while y settles. Looked for after 16, 32, 64,
// ... steps.
bool DualIteration::runs_off() {
  const auto steps = static_cast<unsigned>(solution_->iterations);
  if (steps < 16 || !std::has_single_bit(steps)) return false;
  drift_ = lambda - marked_;
  if (proves_infeasible(program, drift_, motion_)) return true;
  marked_ = lambda;
  return false;
}

bool DualIteration::step_done(double left) {
  ++solution_->iterations;
  if (options_->observe) {
    write();
    options_->observe(solution_->iterations, solution_->z, solution_->lambda);
  }
  constexpr double per_entry = 4;
  const double work = per_entry * solution_->iterations * static_cast<double>(program.G().nonZeros());
  if (!prover_ || !prover_->is_due(work, left)) return false;
  write();
  return prover_->holds(solution_->lambda, *solution_);
}

}  // namespace zwang
