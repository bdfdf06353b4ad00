#include <zwang/solvers/friction/cone_iteration.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace zwang {

bool ConeIteration::begin(const Problem& problem, const SolveOptions& options, Solution& solution,
                          ConeProgram::Want want) {
  problem_ = &problem;
  options_ = &options;
  solution_ = &solution;
  deadline_ = Deadline(options.time_limit);
  if (!program.build(problem, want, options, deadline_, solution)) return false;
  promise_.begin(problem, options, &program);
  v.setZero(program.face().unknowns());
  s.setZero(program.rows());
  if (program.warm(problem, options.warm_start, y)) {
    program.face().force(y, v);
    program.divide_by_mass(v);
  } else {
    y.setZero();
  }
  program.slack(v, s);
  residual_ = program.residual(y, s).natural, work_ = 0;
  solution.status = residual_ == 0 ? Status::solved : Status::iteration_limit;
  if (residual_ == 0) end();
  return residual_ != 0;
}

bool ConeIteration::goes_on(int limit) {
  if (deadline_.passed()) solution_->status = Status::time_limit;
  return solution_->status == Status::iteration_limit &&
         solution_->iterations < std::min(limit, options_->max_iterations);
}

bool ConeIteration::step_done() {
  Solution& solution = *solution_;
  ++solution.iterations;
  if (program.is_dense()) program.face().force(y, v);
  const double unbalanced = program.is_dense() ? 0 : program.imbalance(v, y);
  program.slack(v, s);
  const double scale = program.scale(v);
  const ConeProgram::Residual left = program.residual(y, s);
  residual_ = std::max(left.natural, unbalanced * scale);
  if (options_->observe) {
    program.write(*problem_, v, y, solution);
    options_->observe(solution.iterations, solution.z, solution.lambda);
  }
  if (!std::isfinite(residual_) || program.is_out_of_reach(v)) {
    solution.status = Status::numerical_failure;
    solution.message = "the iterates run off";
    return true;
  }
  // A step goes over the rows a few times, a dense one by lanes.
  work_ = static_cast<double>(program.rows() * v.size()) * solution.iterations;
  if (promise_.is_due(work_) && promise_.holds_at(y, solution)) return true;
  if (residual_ > options_->tolerance * scale || !program.accepts(left, v, *options_)) return false;
  solution.status = Status::solved;
  return true;
}

void ConeIteration::end() {
  if (!std::isnan(solution_->error_bound)) return;
  if (solution_->status == Status::iteration_limit) {
    solution_->message.resize(80);  // of its own: else it would be allocated anew
    const int n = std::snprintf(solution_->message.data(), 80, "the residual stays at %.1e of the motion", residual());
    solution_->message.resize(at(n));
  }
  if (!std::isfinite(residual_)) return solution_->empty_answer();
  program.write(*problem_, v, y, *solution_);
  promise_.judge(*problem_, *options_, *solution_, (y.array() != 0).count() > v.size() ? work_ : infinity);
}

}  // namespace zwang
