#include <zwang/solvers/newton/newton.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/solver_entry.h>

namespace zwang {
namespace {

constexpr Index largest_dense = 2000000;  // unknowns x rows for which the dense method is still a way out
constexpr Index few_bodies = 24;          // unknowns: a look from outside is short, and its bound the nearer one
constexpr Index body = 6;                 // entries of a column of M, at most: joints may leave few unknowns
constexpr double promising_from = 0.01;   // of the motion, and of the last such: a step of d that asks the prover

}  // namespace

void Newton::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  if (!begin(L_.rows, p, options, deadline, s)) return;
  L_.begin(p, options, deadline, penalty);
  const bool many = L_.unknowns() > tolerances::few_unknowns;
  L_.hold_penalty = many ? tolerances::newton_hold_many : tolerances::newton_hold;
  prover_ = begin_prover(p, options);
  if (prover_ && repeats_equalities(L_.rows, &L_.rows.g)) s.error_bound = infinity, prover_ = nullptr;
  polish_.asks = polish && prover_;
  const bool joins = std::ranges::count(L_.rows.equality, 1) > 0;
  looks_ = prover_ && (!polish || (joins && p.M.nonZeros() <= body * p.size()));
  polish_.alone = !dense || p.size() * L_.rows.rows() > largest_dense;
  if (L_.rests()) return L_.write_rest(s);
  using enum AugmentedLagrangian::Held;
  const bool cold = !options.warm_start;
  const auto held = cold && hold_all ? L_.hold_near(deadline) : none;
  bool all_but_known = held == known;
  if (cold && inside && polish && (held == many_left || held == none) && p.size() > tolerances::few_unknowns) {
    const auto end = from_inside(p, options, deadline, s);
    if (end == NewtonStart::End::written || end == NewtonStart::End::limit) return;
    all_but_known = end == NewtonStart::End::accepted;
  }
  const bool bounds = polish && prover_ && (L_.unknowns() > few_bodies || (L_.l.array() > 0).count() > L_.unknowns()) &&
                      L_.rows.free_norm > 0 && !joins;
  polish_.enough = bounds ? prover_->enough(L_.rows.free_norm, L_.rows.exponent) : 0;
  Status end = polish ? run(p, all_but_known, options, deadline, s) : run_alone(p, options, deadline, s);
  if (end == Status::solved || end == Status::infeasible) return;
  const bool limited = end == Status::iteration_limit || end == Status::time_limit;
  if (polish && !limited && !deadline.passed() && !polish_.alone) {
    SolveOptions rest = options;
    rest.time_limit = deadline.left();
    dense->solve(p, rest, s);
    s.handed_to = dense->name();
    s.fallback = true;
    return;
  }
  L_.write(L_.d, L_.l, s);
  s.status = !limited && deadline.passed() ? Status::time_limit : end;
  if (s.status == Status::numerical_failure)
    s.message = polish ? "the rows are too close to dependent for this method, and no dense one takes them"
                       : "the rows are too close to dependent for this method alone, or contradict each other";
}

// What is said to be infeasible is certified as this method certifies it, or left to it.
NewtonStart::End Newton::from_inside(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                     Solution& s) {
  using enum NewtonStart::End;
  const auto end = start ? start(p, options, deadline, s) : failed;
  if (end == accepted) L_.hold_pushing(s.z, s.lambda, deadline);
  if (end != written || s.status != Status::infeasible || polish_.certify_again(L_, p, deadline, s)) return end;
  s.spare.certificate.set_zero(s.certificate, 0);
  return failed;
}

// Solved: the solution is complete.
Status Newton::run(const Problem& p, bool all_but_known, const SolveOptions& options, const Deadline& deadline,
                   Solution& s) {
  if (all_but_known && s.iterations < options.max_iterations) {
    const double rate = L_.rate;
    L_.count(L_.l, options, s);  // rows held: a step like the others
    if (polish_.run(L_, options.tolerance, deadline, s)) return Status::solved;
    if (polish_.doubtful) return Status::numerical_failure;
    L_.rate = rate;
    L_.s = tolerances::newton_hold;
  }
  for (const double close : tolerances::newton_close) {
    const Status end = descend(p, close, options, deadline, s);
    if (end != Status::solved || std::isfinite(s.error_bound) || polish_.run(L_, options.tolerance, deadline, s))
      return end;
    if (polish_.doubtful) break;
  }
  return Status::numerical_failure;
}

Status Newton::run_alone(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& s) {
  for (double close = options.tolerance; close > tolerances::newton_nothing && !deadline.passed(); close /= 10) {
    const Status end = descend(p, close, options, deadline, s);
    if (end != Status::solved || std::isfinite(s.error_bound) || polish_.judge(L_, options.tolerance, deadline, s))
      return end;
  }
  return Status::numerical_failure;
}

// Until a step of l moves d by less than `close`, relative.
Status Newton::descend(const Problem& p, double close, const SolveOptions& options, const Deadline& deadline,
                       Solution& s) {
  double last_move = infinity, promising = promising_from;
  for (;;) {
    before_ = L_.d;
    if (const Status end = L_.minimize(last_move, options, deadline, s); end != Status::solved) return end;
    const double gain = L_.step_multipliers(), move = L_.distance(before_);
    if (last_move < infinity) L_.rate = last_move > 0 ? move / last_move : 0;
    if (looks_ && move <= promising * L_.scale) {
      L_.write(L_.d, L_.l, s);
      if (prover_->holds(s.lambda, s)) return Status::solved;
      promising = promising_from * move / L_.scale;
    }
    if (move <= close * L_.scale) {
      const bool runs_off = gain >= tolerances::out_of_reach * std::max(L_.rows.free_norm, 1.0) * move;
      return runs_off && polish_.certify(L_, p, deadline, s) ? Status::infeasible : Status::solved;
    }
    if (move > tolerances::newton_slow * last_move) L_.s = std::min(10 * L_.s, tolerances::newton_largest_penalty);
    last_move = move;
  }
}

template SolverEntry entry<Newton>(SolverEntry, Newton);

}  // namespace zwang
