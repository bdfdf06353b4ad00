#include <zwang/solvers/rivals/quadratic_programs.h>

#include <algorithm>
#include <piqp/piqp.hpp>

namespace zwang {

void Piqp::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr double least_gap = 1e-14;  // of an objective near 1, what rounding leaves
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  RowsApart::Columns identity(program.size(), program.size());
  const Vector no_cost = Vector::Zero(program.size());
  {
    const Preparation preparing;
    rows.build(program);
    identity.setIdentity();
  }
  deadline.keep();

  piqp::SparseSolver<double> solver;
  auto& settings = solver.settings();
  settings.kkt_solver = condensed ? piqp::KKTSolver::sparse_ldlt_cond : piqp::KKTSolver::sparse_ldlt;
  settings.eps_abs = options.tolerance;
  settings.eps_rel = 0;
  settings.eps_duality_gap_abs = std::max(0.5 * options.tolerance * options.tolerance, least_gap);
  settings.eps_duality_gap_rel = 0;
  settings.max_iter = std::max(1, std::min(max_iterations, options.max_iterations));
  solver.setup(identity, no_cost, rows.E, rows.e, rows.F, rows.f);
  const piqp::Status status = solver.solve();

  const auto& result = solver.result();
  solution.iterations = static_cast<int>(result.info.iter);
  solution.status = meaning(status, {{piqp::PIQP_SOLVED, Status::solved},
                                     {piqp::PIQP_PRIMAL_INFEASIBLE, Status::infeasible},
                                     {piqp::PIQP_MAX_ITER_REACHED, Status::iteration_limit}});
  solution.message = std::string("PIQP: ") + piqp::status_to_string(status);
  Vector lambda;
  rows.join(-result.y, result.z_l, lambda);
  write_answer(problem, program, result.x, lambda, lambda, solution);
}

}  // namespace zwang
