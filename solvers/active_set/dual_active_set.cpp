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
  if (reduced.solve(problem, options, solution)) return;
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
  require_storage(p, options);
  if (!begin(w_, p, options, deadline, s)) return;
  active_.sparse = settings.reduce;
  active_.reset(w_, deadline);
  place_.clear();
  state_.assign(active_.inequalities().size(), resting);
  for (Vector* part : {&v_, &u_, &r_}) part->setZero(active_.freedom());
  slack_.resize(active_.A().cols());
  y_.resize(p.size());
  rest_.resize(active_.padded_size());
  equality_.resize(active_.rank());

  if (equalities_contradict(p, s)) return;
  warm_start(warm_rows_.find(p, w_, options.warm_start));
  const Status end = dual_climb(*this, s.iterations, options.max_iterations, deadline, [&] {
    if (!options.observe) return;
    write(p, s);
    options.observe(s.iterations, s.z, s.lambda);
  });
  if (end == Status::time_limit || end == Status::iteration_limit) {
    write(p, s);
    s.status = end;
    return;
  }
  if (end == Status::infeasible && polish_.certify(p, w_, unit_, s)) return;
  if (settings.polish) {
    const bool failed = polish_.run(p, w_, active_, options.tolerance, s) == Polish::Outcome::failed;
    if (!failed || end == Status::infeasible) return;
    write(p, s);
    s.status = Status::solved_ill_conditioned;
  } else if (end == Status::solved) {
    write(p, s);
    polish_.judge(p, w_, active_, options.tolerance, s);
  } else {
    s.status = Status::numerical_failure;
    s.message = "the rows contradict each other, but not provably";
  }
}

// Reflections, R and N twice; reduced rows; Q and R of the active ones.
void DualActiveSet::Careful::require_storage(const Problem& p, const SolveOptions& options) {
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows());
  const auto e = static_cast<double>(std::count(p.kind.begin(), p.kind.end(), RowKind::equality));
  const double f = std::max(n - e, 0.0);
  storage_.require(n * e + std::min(n, e) * e + 2 * n * f + f * (m - e) + 2 * f * f, options);
}

// Whether an equality row that depends on others provably contradicts them.
bool DualActiveSet::Careful::equalities_contradict(const Problem& p, Solution& s) {
  for (const Index i : active_.rejected()) {
    const double rest = active_.b_of(i);
    if (std::abs(rest) <= tolerances::violation * epsilon * w_.magnitude[i]) continue;
    express(i, rest < 0 ? -1 : 1);
    if (polish_.certify(p, w_, unit_, s)) return true;
  }
  return false;
}

// unit_ = sign (row - its combination of the active rows), r_ being that of the inequality rows.
void DualActiveSet::Careful::express(Index row, double sign) {
  unit_.setZero(w_.rows());
  unit_[row] = sign;
  rest_.setZero();
  w_.add(row, 1, rest_);
  const Index e = active_.rank();
  for (Index j = 0; j < size(); ++j) {
    w_.add(active_[e + j], -r_[j], rest_);
    unit_[active_[e + j]] = std::max(0.0, -sign * r_[j]);
  }
  active_.balance(rest_, equality_);
  for (Index k = 0; k < e; ++k) unit_[active_[k]] = -sign * equality_[k];
}

// Takes in the earlier frame's active rows that are still there and clearly independent; whatever does not fit now is
// dropped again, so a bad guess costs time only.
void DualActiveSet::Careful::warm_start(std::span<const Index> rows) {
  const std::vector<Index>& all = active_.inequalities();
  for (const Index i : rows) {
    if (size() == active_.freedom()) break;
    const Index j = std::ranges::lower_bound(all, i) - all.begin();
    if (active_.qr().split(active_.A().col(j)) > tolerances::warm_share) append(j, 0, 0);
  }
  if (!rows.empty()) restore_dual_feasibility();
}

// (v, u) of the active rows, of which the most negative multiplier leaves until none is left.
void DualActiveSet::Careful::restore_dual_feasibility() {
  for (;;) {
    auto u = u_.head(size());
    for (Index j = 0; j < size(); ++j) u[j] = active_.b()[place_[at(j)]];
    active_.qr().solve_transposed(u);
    v_.noalias() = active_.qr().Q() * u;
    active_.qr().solve(u);
    Index j = 0;
    if (size() == 0 || !(u.minCoeff(&j) < -tolerances::violation * epsilon * (u.cwiseAbs().maxCoeff() + v_.norm())))
      break;
    drop(j);
  }
  u_.head(size()) = u_.head(size()).cwiseMax(0);
}

// The resting row that is violated most on unit rows, or -1.
Index DualActiveSet::Careful::choose() {
  slack_.noalias() = active_.A().transpose() * v_;
  slack_ -= active_.b();
  const double y_norm = std::hypot(active_.y_E_norm(), v_.norm());
  Index worst = -1;
  for (Index j = 0; j < slack_.size(); ++j)
    if (state_[at(j)] == resting && slack_[j] < (worst < 0 ? 0 : slack_[worst]) &&
        -slack_[j] > tolerances::violation * epsilon * (magnitude(j) + y_norm))
      worst = j;
  return worst;
}

double DualActiveSet::Careful::split(Index j) {
  const double length = active_.qr().split(active_.A().col(j));
  auto r = r_.head(size());
  r = active_.qr().components();
  active_.qr().solve(r);
  return length;
}

bool DualActiveSet::Careful::is_satisfied(Index j, double violation) const {
  double terms = magnitude(j);
  for (std::size_t k = 0; k < place_.size(); ++k) terms += std::abs(r_[static_cast<Index>(k)]) * magnitude(place_[k]);
  return violation <= tolerances::violation * epsilon * terms;
}

// Ties go to the steepest.
Blocking<double> DualActiveSet::Careful::blocking() const {
  const Index q = std::ssize(place_);
  const double noise = tolerances::rank * epsilon * (q > 0 ? std::max(1.0, r_.head(q).cwiseAbs().maxCoeff()) : 1.0);
  Blocking<double> first{.row = -1, .step = 0};
  for (Index j = 0; j < q; ++j) {
    if (!(r_[j] > noise)) continue;
    const double step = u_[j] / r_[j];
    if (first.row < 0 || step < first.step || (step == first.step && r_[j] > r_[first.row])) first = {j, step};
  }
  return first;
}

bool DualActiveSet::Careful::contradicts(Index j, double) {
  express(active_.inequalities()[at(j)], 1);
  return true;
}

void DualActiveSet::Careful::move(double step, bool dependent) {
  u_.head(size()) -= step * r_.head(size());
  if (!dependent) v_ += step * active_.qr().remainder();
}

void DualActiveSet::Careful::drop(Index position) {
  state_[at(place_[at(position)])] = resting;
  active_.drop(active_.rank() + position);
  place_.erase(place_.begin() + position);
  for (Index k = position; k < size(); ++k) u_[k] = u_[k + 1];
}

void DualActiveSet::Careful::append(Index j, double multiplier, double) {
  u_[size()] = multiplier;
  active_.accept(j);
  place_.push_back(j);
  state_[at(j)] = active;
  std::replace(state_.begin(), state_.end(), char(retired), char(resting));
}

// The point of the climb, as the factors give it.
void DualActiveSet::Careful::write(const Problem& p, Solution& s) {
  active_.lift(v_, y_);
  unit_.setZero(w_.rows());
  rest_.setZero();
  rest_.head(y_.size()) = y_;
  const Index e = active_.rank();
  for (Index j = 0; j < std::ssize(place_); ++j) {
    const Index row = active_.inequalities()[at(place_[at(j)])];
    unit_[row] = std::max(0.0, u_[j]);
    w_.add(row, -u_[j], rest_);
  }
  active_.balance(rest_, equality_);
  for (Index k = 0; k < e; ++k) unit_[active_[k]] = equality_[k];
  w_.primal(p, y_, s.z);
  w_.multipliers(p, unit_, s.lambda);
}

template SolverEntry entry<DualActiveSet>(SolverEntry);

}  // namespace zwang
