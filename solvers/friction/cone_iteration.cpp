#include <zwang/solvers/friction/cone_iteration.h>

#include <algorithm>
#include <cmath>

namespace zwang {

ConeIteration::ConeIteration(Workspace& work, const Problem& problem, const SolveOptions& options, Solution& solution)
    : work_(work), problem_(problem), options_(options), solution_(solution), deadline_(options.time_limit) {}

bool ConeIteration::begin() {
  if (!work_.program.build(problem_, ConeProgram::Want::any, options_, deadline_, solution_)) return false;
  work_.promise.begin(problem_, options_, &work_.program);
  work_.v.setZero(work_.program.face().unknowns());
  work_.s.setZero(work_.program.rows());
  if (work_.program.warm(problem_, options_.warm_start, work_.y)) {
    work_.program.face().force(work_.y, work_.v);
    work_.program.divide_by_mass(work_.v);
  } else {
    work_.y.setZero();
  }
  work_.program.slack(work_.v, work_.s);
  residual_ = work_.program.residual(work_.y, work_.s).natural;
  solution_.status = residual_ == 0 ? Status::solved : Status::iteration_limit;
  if (residual_ == 0) end();
  return residual_ != 0;
}

bool ConeIteration::goes_on(int limit) {
  if (deadline_.passed()) solution_.status = Status::time_limit;
  return solution_.status == Status::iteration_limit && solution_.iterations < std::min(limit, options_.max_iterations);
}

bool ConeIteration::step_done() {
  ++solution_.iterations;
  ConeProgram& program = work_.program;
  if (program.is_dense()) program.face().force(work_.y, work_.v);
  const double unbalanced = program.is_dense() ? 0 : program.imbalance(work_.v, work_.y);
  program.slack(work_.v, work_.s);
  const double scale = program.scale(work_.v);
  const ConeProgram::Residual left = program.residual(work_.y, work_.s);
  residual_ = std::max(left.natural, unbalanced * scale);
  if (options_.observe) {
    program.write(problem_, work_.v, work_.y, solution_);
    options_.observe(solution_.iterations, solution_.z, solution_.lambda);
  }
  if (!std::isfinite(residual_) || program.is_out_of_reach(work_.v)) {
    solution_.status = Status::numerical_failure;
    solution_.message = "the iterates run off";
    return true;
  }
  // A step goes over the rows a few times, a dense one by lanes.
  const double work = static_cast<double>(program.rows() * work_.v.size()) * solution_.iterations;
  if (work_.promise.is_due(work) && work_.promise.holds_at(work_.y, solution_)) return true;
  if (residual_ > options_.tolerance * scale || !program.accepts(left, work_.v, options_)) return false;
  solution_.status = Status::solved;
  return true;
}

void ConeIteration::end() {
  if (!std::isnan(solution_.error_bound)) return;
  if (std::isfinite(residual_)) return work_.program.write(problem_, work_.v, work_.y, solution_);
  solution_.empty_z();
  solution_.empty_lambda();
}

}  // namespace zwang
