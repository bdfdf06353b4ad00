#include <zwang/solvers/friction/alart_curnier.h>

namespace zwang {

void AlartCurnier::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  ConeIteration iteration(inner, problem, options, solution);
  if (!iteration.begin()) return;
  modes.begin(inner.program, inner.v, inner.y);
  while (iteration.goes_on(max_steps)) {
    if (!modes.step(inner.program)) {
      solution.status = Status::numerical_failure;
      solution.message = "the matrix of the modes breaks down";
      break;
    }
    inner.v = modes.v;
    inner.y = modes.y;
    if (iteration.step_done()) break;
  }
  iteration.end();
}

}  // namespace zwang
