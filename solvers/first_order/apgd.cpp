#include <zwang/solvers/first_order/apgd.h>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

// A lower bound on |G G'|, within a few per cent after ten rounds. The start has every row in it, unevenly, so that a
// symmetric scene is not orthogonal to it. Unit rows: the eigenvalue is at least 1.
double largest_eigenvalue(const UnitProgram& program, int rounds, Vector& lambda, Vector& y) {
  lambda.resize(program.rows());
  for (Index i = 0; i < lambda.size(); ++i) lambda[i] = 1.0 + 0.5 * static_cast<double>(i % 3);
  double eigenvalue = 1;
  for (int round = 0; round < rounds && lambda.norm() > 0; ++round) {
    lambda /= lambda.norm();
    program.motion(lambda, y);
    eigenvalue = std::max(eigenvalue, y.squaredNorm());
    lambda.noalias() = program.G * y;
  }
  return eigenvalue;
}

}  // namespace

void Apgd::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (!iteration.begin(problem, options, solution)) return;
  UnitProgram& program = iteration.program;
  Vector &lambda = iteration.lambda, &y = iteration.y;
  ahead = lambda;
  y_ahead = y;
  double curvature = largest_eigenvalue(program, power_iterations, next, y_next), momentum = 1;
  int cycle = 0, longest = 1;  // steps since the last restart, and the most between two
  while (iteration.goes_on(max_steps)) {
    program.slack(y_ahead, gradient);
    double length = 0;  // of the step in lambda
    for (;;) {
      next = ahead - gradient / curvature;
      program.project(next);
      program.motion(next, y_next);
      length = (next - ahead).norm();
      // Below rounding the bound says nothing.
      const double growth = (y_next - y_ahead).norm(),
                   rounding = tolerances::step_rounding * (y_next.norm() + y_ahead.norm());
      if (!(growth > std::sqrt(curvature) * length + rounding)) break;
      curvature *= 2;
    }

    const bool uphill = restart && gradient.dot(next - lambda) > 0;
    const double next_momentum = uphill ? 1 : 0.5 * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const double carry = uphill ? 0 : (momentum - 1) / next_momentum;
    momentum = next_momentum;
    longest = std::max(longest, ++cycle);
    if (uphill) cycle = 0;
    ahead = next + carry * (next - lambda);
    y_ahead = y_next + carry * (y_next - y);
    lambda.swap(next);
    y.swap(y_next);
    const double to_go = std::sqrt(curvature) * longest * length, scale = program.scale(y);
    if (iteration.step_done(to_go / scale)) return;
    if (to_go <= options.tolerance * scale && program.natural_residual(y, lambda) <= options.tolerance) {
      solution.status = Status::solved;
      break;
    }
  }
  iteration.end();
}

}  // namespace zwang
