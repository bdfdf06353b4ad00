#include <zwang/solvers/first_order/dual_iteration.h>

#include <algorithm>
#include <bit>

namespace zwang {

bool DualIteration::begin() {
  auto& [program, lambda, y, marked, drift, motion, sharpening] = work_;
  if (!program.build(problem_, options_, solution_)) return false;
  program.warm_multipliers(problem_, options_.warm_start, lambda);
  program.motion(lambda, y);
  marked.setZero(program.rows());
  prover_ = begin_prover(problem_, options_);
  solution_.status = Status::iteration_limit;
  return true;
}

bool DualIteration::goes_on(int limit) {
  if (runs_off()) {
    solution_.status = Status::infeasible;
    work_.sharpening.run(work_.program, work_.drift);
    work_.program.write_certificate(problem_, work_.drift, solution_);
    return false;
  }
  if (solution_.iterations >= std::min(limit, options_.max_iterations)) return false;
  if (deadline_.passed()) solution_.status = Status::time_limit;
  return solution_.status == Status::iteration_limit;
}

// On a problem without a solution lambda runs off along a Farkas vector, while y settles. Looked for after 16, 32, 64,
// ... steps.
bool DualIteration::runs_off() {
  const auto steps = static_cast<unsigned>(solution_.iterations);
  if (steps < 16 || !std::has_single_bit(steps)) return false;
  work_.drift = work_.lambda - work_.marked;
  if (proves_infeasible(work_.program, work_.drift, work_.motion)) return true;
  work_.marked = work_.lambda;
  return false;
}

bool DualIteration::step_done() {
  ++solution_.iterations;
  if (options_.observe) {
    write();
    options_.observe(solution_.iterations, solution_.z, solution_.lambda);
  }
  constexpr double per_entry = 4;
  const double work = per_entry * solution_.iterations * static_cast<double>(work_.program.G().nonZeros());
  if (!prover_ || !prover_->is_due(work)) return false;
  write();
  return prover_->holds(solution_.lambda, solution_);
}

}  // namespace zwang
