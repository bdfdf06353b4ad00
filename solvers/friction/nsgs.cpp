#include <zwang/solvers/friction/nsgs.h>

namespace zwang {

void Nsgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (!iteration.begin(problem, options, solution)) return;
  if (!sweeps.begin(iteration.program)) {
    solution.status = Status::unsupported;
    solution.message = "M ties more than 48 unknowns to each other";
    return;
  }
  while (iteration.goes_on(max_sweeps)) {
    sweeps.sweep(iteration.program, iteration.v, iteration.y);
    if (iteration.step_done()) break;
  }
  iteration.end();
}

}  // namespace zwang
