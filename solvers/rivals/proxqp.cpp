#include <zwang/solvers/rivals/quadratic_programs.h>

#include <algorithm>
#include <proxsuite/proxqp/sparse/sparse.hpp>

namespace zwang {
namespace {

namespace peer = proxsuite::proxqp;

}  // namespace

void Proxqp::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr double unbounded = 1e20;
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  const Index n = program.size();
  RowsApart::Columns identity(n, n);
  Vector lambda, y, of_E, of_F;
  {
    const Preparation preparing;
    rows.build(program);
    identity.setIdentity();
    program.warm_multipliers(problem, options.warm_start, lambda);
    program.motion(lambda, y);
    rows.part(-lambda, of_E, of_F);
  }
  deadline.keep();

  peer::sparse::QP<double, int> qp(n, rows.E.rows(), rows.F.rows());
  qp.settings.eps_abs = options.tolerance;
  qp.settings.eps_rel = 0;
  qp.settings.check_duality_gap = true;
  qp.settings.eps_duality_gap_abs = options.tolerance;
  qp.settings.eps_duality_gap_rel = 0;
  qp.settings.max_iter = std::max(1, std::min(max_iterations, options.max_iterations));
  const bool started = warm && options.warm_start;
  qp.settings.initial_guess =
      started ? peer::InitialGuessStatus::WARM_START : peer::InitialGuessStatus::EQUALITY_CONSTRAINED_INITIAL_GUESS;
  const Vector no_cost = Vector::Zero(n), above = Vector::Constant(rows.f.size(), unbounded);
  qp.init(identity, no_cost, rows.E, rows.e, rows.F, rows.f, above);
  if (started)
    qp.solve(y, of_E, of_F);
  else
    qp.solve();

  solution.iterations = static_cast<int>(qp.results.info.iter);
  solution.status =
      meaning(qp.results.info.status, {{peer::QPSolverOutput::PROXQP_SOLVED, Status::solved},
                                       {peer::QPSolverOutput::PROXQP_PRIMAL_INFEASIBLE, Status::infeasible},
                                       {peer::QPSolverOutput::PROXQP_MAX_ITER_REACHED, Status::iteration_limit}});
  solution.message = std::string("ProxQP: ").append(to_string(solution.status));
  rows.join(-qp.results.y, -qp.results.z, lambda);
  write_answer(problem, program, qp.results.x, lambda, lambda, solution);
}

}  // namespace zwang
