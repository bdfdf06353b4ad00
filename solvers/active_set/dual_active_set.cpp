#include <zwang/solvers/active_set/dual_active_set.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/solver_entry.h>

namespace zwang {

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
  if (options.form) reduced.swap_form(*options.form);  // before, too: what the last one left is room for this one
  const bool solved = reduced.solve(problem, options, solution);
  if (options.form) {
    reduced.swap_form(*options.form);
    if (solved) options.form->remember(problem);
  }
  if (solved) return;
  SolveOptions rest = options;
  rest.time_limit = deadline.left();
  solve_carefully(problem, rest, solution);
}

void DualActiveSet::solve_carefully(const Problem& problem, const SolveOptions& options, Solution& solution) {
  careful_.own(problem.size(), problem.rows()).solve(problem, *this, options, solution);
}

void DualActiveSet::Careful::solve(const Problem& p, const DualActiveSet& settings, const SolveOptions& options,
                                   Solution& s) {
  const Deadline deadline(options.time_limit);
  // Reflections, R and N twice; reduced rows; Q and R of the active ones.
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows());
  const auto e = static_cast<double>(std::count(p.kind.begin(), p.kind.end(), RowKind::equality));
  const double f = std::max(n - e, 0.0);
  storage_.require(n * e + std::min(n, e) * e + 2 * n * f + f * (m - e) + 2 * f * f, options);
  if (!begin(rows_, p, options, deadline, s)) return;
  climb_.reset(rows_, settings.reduce, deadline);

  if (equalities_contradict(p, s)) return;
  climb_.warm_start(warm_rows_.find(p, rows_, options.warm_start));
  const Status end = dual_climb(climb_, s.iterations, options.max_iterations, deadline, [&] {
    if (!options.observe) return;
    write(p, s);
    options.observe(s.iterations, s.z, s.lambda);
  });

  if (end == Status::time_limit || end == Status::iteration_limit) {
    write(p, s);
    s.status = end;
    return;
  }
  if (end == Status::infeasible && polish_.certify(p, rows_, climb_.unit(), s)) return;
  if (settings.polish) {
    if (polish_.run(p, rows_, climb_.active(), options, s) || end == Status::infeasible) return;
    write(p, s);
    s.status = Status::solved_ill_conditioned;
  } else if (end == Status::solved) {
    write(p, s);
    polish_.judge(p, rows_, climb_.active(), options, s);
  } else {
    s.status = Status::numerical_failure;
    s.message = "the rows contradict each other, but not provably";
  }
}

// Whether an equality row that depends on others provably contradicts them.
bool DualActiveSet::Careful::equalities_contradict(const Problem& p, Solution& s) {
  constexpr double rounding = tolerances::violation * std::numeric_limits<double>::epsilon();
  for (const Index i : climb_.active().rejected()) {
    const double rest = climb_.active().b_of(i);
    if (std::abs(rest) <= rounding * rows_.magnitude[i]) continue;
    climb_.express(i, rest < 0 ? -1 : 1);
    if (polish_.certify(p, rows_, climb_.unit(), s)) return true;
  }
  return false;
}

void DualActiveSet::Careful::write(const Problem& p, Solution& s) {
  climb_.locate();
  rows_.primal(p, climb_.y(), s.z);
  rows_.multipliers(p, climb_.unit(), s.lambda);
}

template SolverEntry entry<DualActiveSet>(SolverEntry, DualActiveSet);

}  // namespace zwang
