#include <zwang/solvers/rivals/bullet.h>

#include <BulletDynamics/MLCPSolvers/btDantzigLCP.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>

#include <algorithm>

#include <zwang/solvers/rivals/peer_rows.h>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet must be built and used in double precision");

namespace zwang {
namespace {

double lower_limit(const UnitProgram& program, Index i) { return program.is_equality(i) ? -infinity : 0; }

Matrix delassus(const UnitProgram& program, double cfm) {
  const UnitProgram::Rows S = program.G * program.G.transpose();
  Matrix dense(S);
  dense.diagonal().array() += cfm;
  return dense;
}

// What Bullet's multipliers mean for z.
void write(const UnitProgram& program, const Problem& problem, const Vector& lambda, Solution& solution) {
  Vector y;
  program.motion(lambda, y);
  write_answer(problem, program, y, lambda, {}, solution);
}

}  // namespace

// Bullet permutes A, b and the limits in place, so each gets its own copy.
void BulletDantzig::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (!program.build(problem, options, solution)) return;
  solution.iterations = 1;
  const Index k = program.rows();
  Vector lambda = Vector::Zero(k);
  Matrix A = delassus(program, cfm);
  Vector b = program.h, w = Vector::Zero(k), low(k), high = Vector::Constant(k, infinity);
  for (Index i = 0; i < k; ++i) low[i] = lower_limit(program, i);
  std::vector<int> dependency(at(k), -1);
  btDantzigScratchMemory scratch;
  const bool done = btSolveDantzigLCP(static_cast<int>(k), A.data(), lambda.data(), b.data(), w.data(), 0, low.data(),
                                      high.data(), dependency.data(), scratch);
  write(program, problem, lambda, solution);
  const bool answered = done && solution.z.size() == problem.size();
  solution.status = answered ? Status::solved : Status::numerical_failure;
  solution.message = done ? "Bullet: returned true" : "Bullet: returned false";
  if (done && !answered) solution.message += ", but multipliers that are not finite";
}

void BulletPgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return;
  const Index k = program.rows();
  const int size = static_cast<int>(k);
  Vector lambda;
  program.warm_multipliers(problem, options.warm_start, lambda);

  btMatrixXu A(size, size);
  btVectorXu b(size), x(size), low(size), high(size);
  const Matrix S = delassus(program, cfm);
  for (int i = 0; i < size; ++i) {
    b[i] = program.h[i];
    x[i] = lambda[i];
    low[i] = lower_limit(program, i);
    high[i] = infinity;
    for (int j = 0; j < size; ++j) A.setElem(i, j, S(i, j));
  }
  btAlignedObjectArray<int> dependency;
  dependency.resize(size, -1);
  const auto take = [&] {
    for (int i = 0; i < size; ++i) lambda[i] = x[i];
    write(program, problem, lambda, solution);
  };

  // One call asks Bullet for a batch of sweeps; between batches the clock and the observer are looked at.
  const int limit = std::min(max_sweeps, options.max_iterations), batch = options.observe ? 1 : 100;
  btSolveProjectedGaussSeidel solver;
  solver.m_leastSquaresResidualThreshold = options.tolerance * options.tolerance;
  solution.status = Status::iteration_limit;
  while (solution.status == Status::iteration_limit && solution.iterations < limit) {
    if (deadline.passed()) {
      solution.status = Status::time_limit;
      break;
    }
    const int sweeps = std::min(batch, limit - solution.iterations);
    solver.solveMLCP(A, b, x, low, high, dependency, sweeps);
    solution.iterations += sweeps;
    if (solver.m_leastSquaresResidual <= solver.m_leastSquaresResidualThreshold) solution.status = Status::solved;
    if (options.observe) {
      take();
      options.observe(solution.iterations, solution.z, solution.lambda);
    }
  }
  take();
}

}  // namespace zwang
