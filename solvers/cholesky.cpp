#include "solvers/cholesky.h"

#include <cmath>
#include <limits>

#include "solvers/stop.h"

namespace zwang {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

// One step of refinement of y = G_A' l, G_A y = h_A. False when even a fresh factor leaves a large correction.
bool Cholesky::correct() {
  for (int attempt = 0; attempt < 2; ++attempt) {
    const double before = y_.norm();
    double change = infinity;
    for (int pass = 0; pass < 3 && change > refactor_above * before; ++pass) {
      auto r2 = r2_.head(active_.size());
      direction_ = -y_;
      for (const Index i : active_.rows()) active_.add(i, l_[i], direction_);
      for (Index i = 0; i < active_.size(); ++i) r2[i] = w_.h[active_[i]] - active_.dot(active_[i], y_);
      active_.correct(direction_, r2);
      change = direction_.norm();
      if (!std::isfinite(change) || !active_.healthy()) break;
      y_ += direction_;
      for (Index i = 0; i < active_.size(); ++i) l_[active_[i]] += r2[i];
    }
    if (change <= std::max(refactor_above * std::max(before, y_.norm()), std::numeric_limits<double>::min()))
      return true;
    if (!active_.refactor()) return false;
    y_.setZero();
    l_.setZero();
  }
  return false;
}

void Cholesky::drop(Index position) {
  set_aside_[at(active_[position])] = 0;
  l_[active_[position]] = 0;
  active_.drop(position);
}

// The equality rows, and of the warm rows those that keep a positive multiplier: a point the method may start from.
void Cholesky::start(const Problem& p, const SolveOptions& options) {
  const Index n = p.size(), k = w_.rows();
  active_.reset(w_);
  set_aside_.assign(at(k), 0);
  y_.setZero(n);
  l_.setZero(k);
  direction_.resize(n);
  rate_.resize(k);
  r2_.resize(k);
  for (Index i = 0; i < k; ++i)
    if (w_.equality[at(i)]) {
      active_.append(i);
      set_aside_[at(i)] = 1;
    }
  for (const Index i : warm_rows_.find(p, w_, options.warm_start))
    if (active_.accepts(active_.append(i))) set_aside_[at(i)] = 1;
}

Index Cholesky::most_violated() const {
  const double length = y_.norm();
  Index row = -1;
  double worst = 16 * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < w_.rows(); ++i) {
    if (set_aside_[at(i)]) continue;
    const double relative = (w_.h[i] - active_.dot(i, y_)) / (w_.magnitude[i] + length);
    if (relative > worst) {
      worst = relative;
      row = i;
    }
  }
  return row;
}

Cholesky::Step Cholesky::descend(const Problem& p, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  const auto keeps = [&](Index i) { return w_.equality[at(active_[i])] || l_[active_[i]] >= 0; };
  for (bool dropped = true; dropped;) {
    if (!correct()) return Step::stuck;
    dropped = false;
    for (Index i = active_.size(); i-- > 0;)
      if (!keeps(i)) {
        drop(i);
        dropped = true;
      }
  }
  for (;;) {
    const Index r = most_violated();
    if (r < 0) return Step::optimal;
    double entered = 0;
    for (bool full = false; !full;) {
      if (deadline.passed() || s.iterations >= options.max_iterations) {
        s.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
        return Step::limit;
      }
      ++s.iterations;
      auto rate = rate_.head(active_.size());
      direction_ = w_.Gt.col(r);
      active_.combine(direction_, rate);
      for (Index i = 0; i < active_.size(); ++i) active_.add(active_[i], -rate[i], direction_);
      const double share = active_.size() < w_.size() ? direction_.norm() : 0;
      if (active_.undecided(share) || !active_.healthy()) return Step::stuck;

      // How far until r holds, and until the first multiplier reaches zero.
      const double whole = active_.accepts(share) ? (w_.h[r] - active_.dot(r, y_)) / (share * share) : infinity;
      double partial = infinity;
      Index leaving = -1;
      for (Index i = 0; i < active_.size(); ++i) {
        if (w_.equality[at(active_[i])] || rate[i] <= 1e-13) continue;
        const double reach = std::max(l_[active_[i]], 0.0) / rate[i];
        if (reach < partial) {
          partial = reach;
          leaving = i;
        }
      }
      const double step = std::min(whole, partial);
      if (step == infinity) return Step::optimal;  // no row can give way: the polish proves it
      y_ += step * direction_;
      for (Index i = 0; i < active_.size(); ++i) l_[active_[i]] -= step * rate[i];
      entered += step;
      full = whole <= partial;
      if (!full) {
        drop(leaving);
        continue;
      }
      if (!active_.accepts(active_.append(r))) return Step::stuck;
      set_aside_[at(r)] = 1;
      l_[r] = entered;
      if (!correct()) return Step::stuck;
    }
    if (options.observe) {
      w_.primal(p, y_, s.z);
      w_.multipliers(p, l_, s.lambda);
      options.observe(s.iterations, s.z, s.lambda);
    }
  }
}

void Cholesky::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  s.reset(p.size(), p.rows());
  if (!w_.build(p)) {
    s.status = Status::bad_input;
    s.message = "M is not positive definite";
    return;
  }
  if (w_.conflict >= 0) {
    s.status = Status::infeasible;
    s.certificate = zero_row_certificate(p, w_.conflict);
    return;
  }
  start(p, options);
  const Step end = descend(p, options, s);
  if (end == Step::limit) {
    w_.primal(p, y_, s.z);
    w_.multipliers(p, l_, s.lambda);
    return;
  }
  if (end == Step::optimal && polish_.run(p, w_, active_, options.tolerance, s) != Polish::Outcome::failed) return;
  orthogonal_.reset(w_);
  for (Index i = 0; i < w_.rows(); ++i)
    if (w_.equality[at(i)]) orthogonal_.append(i);
  for (const Index i : active_.rows())
    if (!w_.equality[at(i)]) orthogonal_.append(i);
  s.message.clear();
  s.redundant.clear();
  polish_.run(p, w_, orthogonal_, options.tolerance, s);
  s.fallback = true;
}

}  // namespace zwang
