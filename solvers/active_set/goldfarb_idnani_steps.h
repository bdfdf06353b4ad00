#pragma once

#include <zwang/solvers/active_set/goldfarb_idnani.h>

// The climb of Goldfarb & Idnani's method: where it begins, which row enters, which one blocks it, and the step
// between.

namespace zwang {

// Takes in the earlier frame's active rows that are still there and clearly independent; whatever does not fit now is
// dropped again, so a bad guess costs time only.
template <class Scalar>
void GoldfarbIdnani<Scalar>::warm_start(const BasicProblem<Scalar>& p, const WarmStart& warm) {
  const Scalar clear(1e-7);
  const std::size_t known = std::min(warm.key.size(), static_cast<std::size_t>(warm.lambda.size()));
  std::vector<Index>& sorted = active_rows_;
  sorted.clear();
  for (std::size_t k = 0; k < known; ++k) sorted.push_back(static_cast<Index>(k));
  std::sort(sorted.begin(), sorted.end(),
            [&](Index a, Index b) { return warm.key[a] != warm.key[b] ? warm.key[a] < warm.key[b] : a < b; });
  for (Index j = 0; j < A_.cols() && updates_.size() < A_.rows(); ++j) {
    const RowKey& key = p.key[whitened_.row[inequalities_[j]]];
    const auto at =
        std::lower_bound(sorted.begin(), sorted.end(), key, [&](Index a, const RowKey& k) { return warm.key[a] < k; });
    if (at == sorted.end() || warm.key[*at] != key || !(warm.lambda[*at] > 0)) continue;
    if (!(updates_.split(A_.col(j)) > clear)) continue;
    updates_.append();
    active_.push_back(j);
    state_[j] = active;
  }
  refresh();
  restore_dual_feasibility();
}

template <class Scalar>
Status GoldfarbIdnani<Scalar>::climb(const BasicProblem<Scalar>& p, const SolveOptions& options) {
  for (Index row = most_violated(); row >= 0; row = most_violated())
    if (const Status status = enter(row, p, options); status != Status::unsolved) return status;
  return Status::solved;
}

// The resting row that is violated most on unit rows, or -1.
template <class Scalar>
Index GoldfarbIdnani<Scalar>::most_violated() {
  using std::sqrt;
  slack_.noalias() = A_.transpose() * v_;
  slack_ -= b_;
  const Scalar y_norm = sqrt(y_E_norm_ * y_E_norm_ + v_.squaredNorm());
  Index worst = -1;
  for (Index j = 0; j < slack_.size(); ++j)
    if (state_[j] == resting && (worst < 0 ? slack_[j] < Scalar(0) : slack_[j] < slack_[worst]) &&
        -slack_[j] > violation_tolerance() * (magnitude_[j] + y_norm))
      worst = j;
  return worst;
}

// The active row whose multiplier reaches zero first along u - t r, or -1. Ties go to the steepest.
template <class Scalar>
Index GoldfarbIdnani<Scalar>::blocking(Scalar& step) const {
  using std::abs;
  const Index q = updates_.size();
  const Scalar noise =
      rank_tolerance() * (q > 0 ? std::max(Scalar(1), Scalar(r_.head(q).cwiseAbs().maxCoeff())) : Scalar(1));
  Index first = -1;
  for (Index j = 0; j < q; ++j) {
    if (!(r_[j] > noise)) continue;
    const Scalar t = u_[j] / r_[j];
    if (first >= 0 && !(t < step || (t == step && r_[j] > r_[first]))) continue;
    step = t;
    first = j;
  }
  return first;
}

template <class Scalar>
Status GoldfarbIdnani<Scalar>::enter(Index p, const BasicProblem<Scalar>& problem, const SolveOptions& options) {
  using std::abs;
  Scalar multiplier(0);
  while (true) {
    if (iterations >= options.max_iterations) return Status::iteration_limit;
    if (deadline_.passed()) return Status::time_limit;
    ++iterations;
    const Index q = updates_.size();
    const Scalar length = updates_.split(A_.col(p));
    auto r = r_.head(q);
    r = updates_.components();
    updates_.solve(r);
    const Scalar violation = std::max(Scalar(0), Scalar(b_[p] - A_.col(p).dot(v_)));
    Scalar step(0);
    const Index block = blocking(step);

    // A combination of the active rows: contradicted by them, or satisfied to rounding, or one of them must leave.
    const bool dependent = !(length > rank_tolerance());
    if (dependent) {
      largest_rejected = std::max(largest_rejected, length);
      Scalar size = magnitude_[p];
      for (Index j = 0; j < q; ++j) size += abs(r_[j]) * magnitude_[active_[j]];
      const bool holds = violation <= violation_tolerance() * size;
      if (!holds && block < 0 && certify(problem, inequalities_[p], Scalar(1), length)) return Status::infeasible;
      if (holds || block < 0) {
        state_[p] = retired;
        return Status::unsolved;
      }
    }

    const Scalar full = dependent ? Scalar(0) : Scalar(violation / (length * length));
    const bool blocked = block >= 0 && (dependent || step < full);
    if (!blocked) step = full;
    u_.head(q) -= step * r;
    multiplier += step;
    if (!dependent) v_ += step * updates_.remainder();
    if (blocked) {
      drop(block);
      continue;
    }
    updates_.append();
    u_[q] = multiplier;
    active_.push_back(p);
    state_[p] = active;
    for (char& state : state_)
      if (state == retired) state = resting;
    if (options.observe) observe(problem, options.observe);
    return Status::unsolved;
  }
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::drop(Index j) {
  state_[active_[j]] = resting;
  updates_.remove(j);
  active_.erase(active_.begin() + j);
  for (Index k = j; k < updates_.size(); ++k) u_[k] = u_[k + 1];
}

// (v, u) afresh from the factor.
template <class Scalar>
void GoldfarbIdnani<Scalar>::refresh() {
  const Index q = updates_.size();
  auto u = u_.head(q);
  for (Index j = 0; j < q; ++j) u[j] = b_[active_[j]];
  updates_.solve_transposed(u);
  v_.noalias() = updates_.Q() * u;
  updates_.solve(u);
}

// Drops the most negative multiplier until none is left. True when there was none.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::restore_dual_feasibility() {
  bool clean = true;
  while (updates_.size() > 0) {
    const auto u = u_.head(updates_.size());
    Index j = 0;
    if (!(u.minCoeff(&j) < -violation_tolerance() * (u.cwiseAbs().maxCoeff() + v_.norm()))) break;
    drop(j);
    refresh();
    clean = false;
  }
  u_.head(updates_.size()) = u_.head(updates_.size()).cwiseMax(Scalar(0));
  return clean;
}

}  // namespace zwang
