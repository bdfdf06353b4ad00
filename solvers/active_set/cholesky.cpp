#include <zwang/solvers/active_set/cholesky.h>

#include <cmath>
#include <limits>

#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/solver_entry.h>

namespace zwang {

// Refines y = G_A' l, G_A y = h_A. False when even a fresh factor leaves a large correction.
bool Cholesky::Method::correct(ActiveRows& active) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    const double before = y_.norm();
    double change = infinity;
    for (int pass = 0; pass < 3 && change > refactor_above_ * before; ++pass) {
      auto r2 = r2_.head(active.size());
      direction_ = -y_;
      for (const Index i : active.rows()) active.add(i, l_[i], direction_);
      for (Index i = 0; i < active.size(); ++i) r2[i] = w_.h[active[i]] - active.dot(active[i], y_);
      active.correct(direction_, r2);
      change = direction_.norm();
      if (!std::isfinite(change) || !active.healthy()) break;
      y_ += direction_;
      for (Index i = 0; i < active.size(); ++i) l_[active[i]] += r2[i];
    }
    if (change <= std::max(refactor_above_ * std::max(before, y_.norm()), std::numeric_limits<double>::min()))
      return true;
    if (!active.refactor()) return false;
    y_.setZero();
    l_.setZero();
  }
  return false;
}

void Cholesky::Method::drop(Index position) {
  set_aside_[at((*active_)[position])] = 0;
  l_[(*active_)[position]] = 0;
  active_->drop(position);
}

// The equality rows, then `guess`: those of them that keep a positive multiplier make a point the method may start
// from.
void Cholesky::Method::start(ActiveRows& active, std::span<const Index> guess, const Deadline& deadline) {
  active_ = &active;
  stuck_ = false;
  active.reset(w_, deadline);
  set_aside_.assign(at(w_.rows()), 0);
  y_.setZero(w_.size());
  l_.setZero(w_.rows());
  for (Index i = 0; i < w_.rows(); ++i)
    if (w_.equality[at(i)]) {
      active.append(i);
      set_aside_[at(i)] = 1;
    }
  for (const Index i : guess)
    if (!w_.equality[at(i)] && active.accepts(active.append(i))) set_aside_[at(i)] = 1;
}

Index Cholesky::Method::choose() const {
  const double length = y_.norm();
  Index row = -1;
  double worst = tolerances::violation * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < w_.rows(); ++i) {
    if (set_aside_[at(i)]) continue;
    const double relative = (w_.h[i] - active_->dot(i, y_)) / (w_.magnitude[i] + length);
    if (relative > worst) {
      worst = relative;
      row = i;
    }
  }
  return row;
}

// Corrects the start, and drops what pulls, until nothing does.
bool Cholesky::Method::settle() {
  for (bool dropped = true; dropped;) {
    if (!correct(*active_)) return false;
    dropped = false;
    for (Index i = active_->size(); i-- > 0;)
      if (const Index row = (*active_)[i]; !w_.equality[at(row)] && !(l_[row] >= 0)) {
        drop(i);
        dropped = true;
      }
  }
  return true;
}

double Cholesky::Method::split(Index p) {
  direction_.setZero(w_.size());
  w_.add(p, 1, direction_);
  active_->combine(direction_, rate_.head(active_->size()));
  const double share = active_->size() < w_.size() ? direction_.norm() : 0;
  stuck_ = active_->undecided(share) || !active_->healthy();
  return share;
}

Blocking<double> Cholesky::Method::blocking() const {
  const ActiveRows& active = *active_;
  Blocking<double> first{.row = -1, .step = infinity};
  for (Index i = 0; i < active.size(); ++i) {
    if (w_.equality[at(active[i])] || rate_[i] <= tolerances::falling) continue;
    const double step = std::max(l_[active[i]], 0.0) / rate_[i];
    if (step < first.step) first = {i, step};
  }
  return first;
}

bool Cholesky::Method::contradicts(Index p, double) {
  proof_.setZero(w_.rows());
  proof_[p] = 1;
  for (Index i = 0; i < active_->size(); ++i) proof_[(*active_)[i]] = -rate_[i];
  return true;
}

void Cholesky::Method::move(double step, bool dependent) {
  if (!dependent) y_ += step * direction_;
  for (Index i = 0; i < active_->size(); ++i) l_[(*active_)[i]] -= step * rate_[i];
}

void Cholesky::Method::append(Index p, double multiplier, double) {
  stuck_ = !active_->accepts(active_->append(p));
  if (stuck_) return;
  set_aside_[at(p)] = 1;
  l_[p] = multiplier;
  stuck_ = !correct(*active_);
}

// False: the factors were too coarse for this problem.
bool Cholesky::Method::attempt(const Problem& p, ActiveRows& active, std::span<const Index> guess,
                               const SolveOptions& options, const Deadline& deadline, Solution& s) {
  start(active, guess, deadline);
  const auto write = [&] {
    w_.primal(p, y_, s.z);
    w_.multipliers(p, l_, s.lambda);
  };
  const auto entered = [&] {
    if (!options.observe) return;
    write();
    options.observe(s.iterations, s.z, s.lambda);
  };
  const Status end =
      settle() ? dual_climb(*this, s.iterations, options.max_iterations, deadline, entered) : Status::numerical_failure;
  if (!polishes_) found_.assign(active.rows().begin(), active.rows().end());
  const bool limited = end == Status::time_limit || end == Status::iteration_limit;
  if (limited || !polishes_) write();
  if (limited) {
    s.status = end;
    return true;
  }
  if (end == Status::numerical_failure && &active == &sparse_) return false;
  if (!polishes_ && end == Status::infeasible) {
    if (polish_.certify(p, w_, proof_, s)) return true;
    s.status = Status::numerical_failure;
    s.message = "a row contradicts the active ones, but not provably";
    return false;
  }
  if (!polishes_) {
    polish_.judge(p, w_, active, options, s);
    return s.status == Status::solved;
  }
  return polish_.run(p, w_, active, options, s) && s.status != Status::solved_ill_conditioned;
}

void Cholesky::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  method_.solve(*this, p, options, s);
}

void Cholesky::Method::solve(const Problem& p, const Cholesky& settings, const SolveOptions& options, Solution& s) {
  refactor_above_ = settings.refactor_above;
  polishes_ = settings.polish;
  const Deadline deadline(options.time_limit);
  if (!begin(w_, p, options, deadline, s)) return;
  direction_.resize(p.size());
  rate_.resize(w_.rows());
  r2_.resize(w_.rows());
  if (attempt(p, sparse_, warm_rows_.find(p, w_, options.warm_start), options, deadline, s)) return;
  s.message.clear();
  s.redundant.clear();
  s.margins = {};
  const auto n = static_cast<double>(p.size()), most = std::min(n, static_cast<double>(p.rows()));
  storage_.require(n * most + most * most, options);
  attempt(p, orthogonal_, polishes_ ? std::span<const Index>(sparse_.rows()) : found_, options, deadline, s);
  s.fallback = true;
}

template SolverEntry entry<Cholesky>(SolverEntry, Cholesky);

}  // namespace zwang
