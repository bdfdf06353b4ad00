#include <zwang/solvers/rivals/quadratic_programs.h>

#include <daqp/api.h>

#include <algorithm>

namespace zwang {
namespace {

static_assert(std::is_same_v<c_float, double>, "DAQP in single precision");

Status status_of(int flag) {
  return meaning(flag, {{DAQP_EXIT_OPTIMAL, Status::solved},
                        {DAQP_EXIT_INFEASIBLE, Status::infeasible},
                        {DAQP_EXIT_ITERLIMIT, Status::iteration_limit},
                        {DAQP_EXIT_TIMELIMIT, Status::time_limit}});
}

}  // namespace

void Daqp::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr double least_tolerance = 1e-14;
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  Vector warm;
  {
    const Preparation preparing;
    lower = program.h;
    upper.setConstant(program.rows(), DAQP_INF);
    program.warm_multipliers(problem, options.warm_start, warm);
  }
  Gt = program.G.transpose();  // the method's own matrix, not preparation

  DAQPProblem qp = {};
  qp.n = static_cast<int>(program.size());
  qp.m = static_cast<int>(program.rows());
  qp.A = Gt.data();
  qp.blower = lower.data();
  qp.bupper = upper.data();
  DAQPSettings limits;
  daqp_default_settings(&limits);
  limits.primal_tol = std::max(options.tolerance, least_tolerance);
  limits.iter_limit = std::min({max_iterations, options.max_iterations, 1'000'000'000}) + 1;
  limits.time_limit = seconds_left(deadline, 0);
  y.resize(program.size());
  lambda.setZero(program.rows());
  DAQPResult result = {};
  result.x = y.data();
  result.lam = lambda.data();

  const auto run = [&](bool with_warm_rows) {
    sense.assign(at(program.rows()), 0);
    for (Index i = 0; i < program.rows(); ++i) {
      int& flags = sense[at(i)];
      if (program.is_equality(i)) {
        upper[i] = lower[i];
        flags = DAQP_ACTIVE | DAQP_IMMUTABLE;
      } else if (with_warm_rows && warm[i] > 0) {
        flags = DAQP_ACTIVE | DAQP_LOWER;
      }
    }
    qp.sense = sense.data();
    DAQPWorkspace workspace = {};
    workspace.settings = &limits;
    const int mask = DAQP_UPDATE_unconstrained | (eliminate ? DAQP_UPDATE_eliminate : 0);
    result.exitflag = setup_daqp_main(&qp, &workspace, nullptr, mask);
    if (result.exitflag < 0) return;
    daqp_solve(&result, &workspace);
    workspace.settings = nullptr;
    free_daqp_workspace(&workspace);
    free_daqp_ldp(&workspace);
  };
  const bool guessed = (warm.array() > 0).any();
  run(guessed);
  if (guessed && result.exitflag < 0 && status_of(result.exitflag) == Status::numerical_failure) run(false);

  solution.iterations = result.iter;
  solution.status = status_of(result.exitflag);
  solution.message = "DAQP: exit flag " + std::to_string(result.exitflag);
  lambda = -lambda;  // DAQP's is negative at a lower bound
  if (solution.status != Status::solved) y.resize(0);
  write_answer(problem, program, y, lambda, lambda, solution);
}

}  // namespace zwang
