#include <zwang/solvers/friction/nsgs.h>

namespace zwang {

void Nsgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  ConeIteration iteration(inner, problem, options, solution);
  if (!iteration.begin()) return;
  if (!sweeps.begin(inner.program)) {
    solution.status = Status::unsupported;
    solution.message = "M ties more than 48 unknowns to each other";
    return;
  }
  while (iteration.goes_on(max_sweeps)) {
    sweeps.sweep(inner.program, inner.v, inner.y);
    if (iteration.step_done()) break;
  }
  iteration.end();
}

}  // namespace zwang
