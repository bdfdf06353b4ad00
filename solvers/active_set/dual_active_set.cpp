#include <zwang/solvers/active_set/dual_active_set.h>

#include <zwang/solvers/solver_entry.h>

namespace zwang {

template class GoldfarbIdnani<double>;

void DualActiveSet::Careful::write(const Problem& problem, Solution& solution) const {
  solution.z = method_.z().cast<double>();
  solution.lambda = method_.lambda().cast<double>();
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_equality(i)) solution.lambda[i] = std::max(0.0, solution.lambda[i]);
}

// Polish decides over the rows that the method dropped or found contradicted. Where it cannot either, a point of the
// method stands, flagged; a contradiction without proof does not.
void DualActiveSet::Careful::judge_again(const Problem& problem, double tolerance, const Deadline& deadline,
                                         Solution& solution) {
  active_.reset(method_.whitened(), deadline);
  for (const Index i : method_.accepted_equalities()) active_.append(i);
  for (const Index i : method_.active_inequalities()) active_.append(i);
  const bool has_point = solution.status != Status::infeasible;
  const Polish::Outcome outcome = polish_.run(problem, method_.whitened(), active_, tolerance, solution);
  solution.fallback = true;
  if (outcome == Polish::Outcome::failed && has_point) {
    write(problem, solution);
    solution.status = Status::solved_ill_conditioned;
  }
}

// Hands or towers that no row connects are solved apart: time then grows with their number, not with its cube.
void DualActiveSet::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  constexpr Index body = 6;
  reduced_.begin();
  careful_.begin();
  if (!reduce || options.observe || problem.size() % body != 0) return solve_carefully(problem, options, solution);
  islands_.solve_apart([this](const Problem& p, const SolveOptions& o, Solution& part) { solve_island(p, o, part); },
                       body, problem, options, solution);
}

void DualActiveSet::solve_island(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  solution.reset(problem.size(), problem.rows());
  JointSpaceActiveSet& reduced = reduced_.of(problem.size(), JointGraph::kind(problem));
  reduced.polish = polish;
  if (reduced.solve(problem, options, solution)) return;
  SolveOptions rest = options;
  rest.time_limit = deadline.left();
  solve_carefully(problem, rest, solution);
}

void DualActiveSet::solve_carefully(const Problem& problem, const SolveOptions& options, Solution& solution) {
  careful_.own(problem.size(), problem.rows()).solve(problem, *this, options, solution);
}

void DualActiveSet::Careful::solve(const Problem& problem, const DualActiveSet& settings, const SolveOptions& options,
                                   Solution& solution) {
  const Deadline deadline(options.time_limit);
  solution.reset(problem.size(), problem.rows());
  method_.sparse = settings.reduce;
  method_.polish = settings.polish;
  solution.status = method_.solve(problem, options);
  solution.iterations = method_.iterations;
  if (solution.status == Status::bad_input) {
    solution.reset(0, 0);
    solution.status = Status::bad_input;
    solution.message = "M is not positive definite";
    return;
  }
  if (solution.status == Status::infeasible) {
    if (method_.proof_in_doubt && !settings.polish) {
      solution.status = Status::numerical_failure;
      solution.message = "the rows contradict each other, but not provably";
    } else if (method_.proof_in_doubt)
      judge_again(problem, options.tolerance, deadline, solution);
    else
      solution.zero_certificate(problem.rows()) = method_.certificate;
  } else {
    write(problem, solution);
  }
  // Accepted rows are judged by what their pivots do to z, not by their size: a limit of 1e-10 flagged wedges and
  // linkages that were right to the last bit.
  if (solution.status == Status::solved && !solution.fallback) {
    solution.redundant = method_.redundant;
    solution.margins = {.rank = method_.rank,
                        .smallest_accepted = method_.smallest_accepted,
                        .largest_rejected = method_.largest_rejected};
    const double limit = accepted_error(options.tolerance);
    if (!method_.contracted || method_.largest_rejected > tolerances::clear_rest || method_.error(problem) > limit ||
        method_.leaves_in_doubt(problem, limit)) {
      if (settings.polish)
        judge_again(problem, options.tolerance, deadline, solution);
      else
        solution.status = Status::solved_ill_conditioned;
    }
  }
  if (solution.status == Status::infeasible) {
    solution.empty_z();
    solution.empty_lambda();
  }
}

template SolverEntry entry<DualActiveSet>(SolverEntry);

}  // namespace zwang
