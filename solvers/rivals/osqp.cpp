#include <zwang/solvers/rivals/quadratic_programs.h>

#include <osqp.h>

#include <algorithm>
#include <memory>

namespace zwang {
namespace {

static_assert(std::is_same_v<OSQPFloat, double>, "OSQP in single precision");

// A matrix in OSQP's terms, whose integers may be of either length.
struct Columns {
  explicit Columns(const SparseMatrix& matrix)
      : first(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.cols() + 1),
        row(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros()),
        value(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros()) {
    OSQPCscMatrix_set_data(&view, static_cast<OSQPInt>(matrix.rows()), static_cast<OSQPInt>(matrix.cols()),
                           static_cast<OSQPInt>(matrix.nonZeros()), value.data(), row.data(), first.data());
  }
  std::vector<OSQPInt> first, row;
  std::vector<OSQPFloat> value;
  OSQPCscMatrix view = {};
};

struct Cleanup {
  void operator()(OSQPSolver* solver) const { osqp_cleanup(solver); }
};

}  // namespace

void Osqp::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  // Of a dual ray, relative: tight enough for none on feasible rows, loose enough to be met.
  constexpr double rough_ray = 1e-6;
  constexpr double unlimited = 1e10;  // seconds
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  const Index n = program.size(), k = program.rows();
  Vector lambda, y, ray;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, y);
  SparseMatrix identity(n, n);
  identity.setIdentity();
  std::unique_ptr<Columns> P, A;
  Vector upper = program.h;
  {
    const Preparation preparing;
    P = std::make_unique<Columns>(identity);
    A = std::make_unique<Columns>(SparseMatrix(program.G));
    for (Index i = 0; i < k; ++i)
      if (!program.is_equality(i)) upper[i] = OSQP_INFTY;
  }

  OSQPSettings settings;
  osqp_set_default_settings(&settings);
  settings.verbose = 0;
  settings.polishing = polish;
  settings.eps_abs = options.tolerance;
  settings.eps_rel = 0;
  settings.eps_prim_inf = rough_ray;
  settings.max_iter = std::max(1, std::min(max_iterations, options.max_iterations));
  settings.time_limit = seconds_left(deadline, unlimited);
  const Vector q = Vector::Zero(n);
  OSQPSolver* opened = nullptr;
  const OSQPInt error = osqp_setup(&opened, &P->view, q.data(), &A->view, program.h.data(), upper.data(),
                                   static_cast<OSQPInt>(k), static_cast<OSQPInt>(n), &settings);
  const std::unique_ptr<OSQPSolver, Cleanup> solver(opened);
  if (error != 0) {
    solution.status = Status::numerical_failure;
    solution.message = std::string("OSQP: ") + osqp_error_message(error);
    return write_answer(problem, program, {}, {}, {}, solution);
  }
  if (options.warm_start) {
    lambda = -lambda;
    osqp_warm_start(solver.get(), y.data(), lambda.data());
  }
  osqp_solve(solver.get());

  const OSQPInfo& info = *solver->info;
  solution.iterations = static_cast<int>(info.iter);
  // What it calls inaccurate is at its limit, within ten times the tolerance.
  solution.status = meaning<OSQPInt>(info.status_val, {{OSQP_SOLVED, Status::solved},
                                                       {OSQP_PRIMAL_INFEASIBLE, Status::infeasible},
                                                       {OSQP_MAX_ITER_REACHED, Status::iteration_limit},
                                                       {OSQP_SOLVED_INACCURATE, Status::iteration_limit},
                                                       {OSQP_PRIMAL_INFEASIBLE_INACCURATE, Status::iteration_limit},
                                                       {OSQP_DUAL_INFEASIBLE_INACCURATE, Status::iteration_limit},
                                                       {OSQP_TIME_LIMIT_REACHED, Status::time_limit}});
  solution.message = std::string("OSQP: ") + info.status;
  if (solution.status == Status::solved && polish && info.status_polish != OSQP_POLISH_SUCCESS)
    solution.message += ", not polished";
  if (solution.status == Status::infeasible) ray = -Eigen::Map<const Vector>(solver->solution->prim_inf_cert, k);
  y = Eigen::Map<const Vector>(solver->solution->x, n);
  lambda = -Eigen::Map<const Vector>(solver->solution->y, k);
  write_answer(problem, program, y, lambda, ray, solution);
}

}  // namespace zwang
