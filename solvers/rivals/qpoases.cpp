#include <zwang/solvers/rivals/quadratic_programs.h>

#include <algorithm>
#include <qpOASES.hpp>

namespace zwang {
namespace {

namespace peer = qpOASES;
static_assert(std::is_same_v<peer::real_t, double>, "qpOASES in single precision");

Status status_of(peer::returnValue code, bool infeasible) {
  if (infeasible) return Status::infeasible;
  return meaning(code, {{peer::SUCCESSFUL_RETURN, Status::solved},
                        {peer::RET_INIT_FAILED_INFEASIBILITY, Status::infeasible},
                        {peer::RET_QP_INFEASIBLE, Status::infeasible},
                        {peer::RET_MAX_NWSR_REACHED, Status::iteration_limit}});
}

}  // namespace

void Qpoases::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr double unlimited = 1e10;  // seconds
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  const Index n = program.size(), k = program.rows();
  Vector lambda, y, upper = program.h;
  {
    const Preparation preparing;
    program.warm_multipliers(problem, options.warm_start, lambda);
    program.motion(lambda, y);
    for (Index i = 0; i < k; ++i)
      if (!program.is_equality(i)) upper[i] = peer::INFTY;
  }
  Gt = program.G.transpose();  // the method's own matrix, not preparation

  peer::QProblem qp(static_cast<peer::int_t>(n), static_cast<peer::int_t>(k), peer::HST_IDENTITY);
  peer::Options given;
  if (mpc) given.setToMPC();
  given.printLevel = peer::PL_NONE;
  given.terminationTolerance = options.tolerance;
  qp.setOptions(given);
  const Vector no_cost = Vector::Zero(n);
  Vector start = Vector::Zero(n + k);  // multipliers of bounds, then of rows
  start.tail(k) = lambda;
  const bool started = lambda.size() == k && (lambda.array() != 0).any();
  peer::int_t steps = std::min(max_iterations, options.max_iterations);
  const peer::int_t most_steps = steps;
  double seconds = seconds_left(deadline, unlimited);
  const double most_seconds = seconds;
  const auto code = qp.init(nullptr, no_cost.data(), Gt.data(), nullptr, nullptr, program.h.data(), upper.data(), steps,
                            &seconds, started ? y.data() : nullptr, started ? start.data() : nullptr);

  solution.iterations = static_cast<int>(steps);
  solution.status = status_of(code, qp.isInfeasible());
  if (solution.status == Status::iteration_limit && steps < most_steps && seconds >= 0.9 * most_seconds)
    solution.status = Status::time_limit;
  solution.message = "qpOASES: return code " + std::to_string(static_cast<int>(code));
  qp.getPrimalSolution(y.data());
  qp.getDualSolution(start.data());
  lambda = start.tail(k);
  write_answer(problem, program, y, lambda, {}, solution);
}

}  // namespace zwang
