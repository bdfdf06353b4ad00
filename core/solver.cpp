#include "core/solver.h"

namespace zwang {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::unsolved:
      return "unsolved";
    case Status::solved:
      return "solved";
    case Status::solved_ill_conditioned:
      return "solved, ill-conditioned";
    case Status::infeasible:
      return "infeasible";
    case Status::iteration_limit:
      return "iteration limit";
    case Status::time_limit:
      return "time limit";
    case Status::unsupported:
      return "unsupported";
    case Status::bad_input:
      return "bad input";
    case Status::numerical_failure:
      return "numerical failure";
    case Status::crashed:
      return "crashed";
  }
  return "unknown";
}

void AnySolver::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  require_matching_sizes(problem);
  solution.message = bad_input(problem);
  if (!solution.message.empty()) {
    const std::string reason = solution.message;
    solution.reset(0, 0);
    solution.status = Status::bad_input;
    solution.message = reason;
    return;
  }
  solve_(problem, options, solution);
  const bool claims_z = solution.status == Status::solved || solution.status == Status::solved_ill_conditioned;
  if (claims_z && !solution.z.allFinite()) {
    solution.status = Status::numerical_failure;
    solution.message = "the answer does not fit a double";
  }
}

Solution AnySolver::solve(const Problem& problem, const SolveOptions& options) {
  Solution solution;
  solve(problem, options, solution);
  return solution;
}

}  // namespace zwang
