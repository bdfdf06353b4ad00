#include <zwang/core/referee/referee_active_set.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang {

OrthogonalRows::Split RefereeActiveSet::split(Index row) {
  work_left_ -= 8.0 * static_cast<double>(scaled_.size()) * static_cast<double>(rows.rank() + 1);
  return rows.split(scaled_.unit_row(row));
}

RefereeActiveSet::Outcome RefereeActiveSet::solve(const ExtendedVector& guess_d, const ExtendedVector* guess_lambda) {
  place_.assign(at(scaled_.rows()), 0);
  rows = OrthogonalRows(scaled_.size());
  guess(guess_d, guess_lambda);
  if (!refine()) return Outcome::gave_up;
  for (Index rounds = 10 * (scaled_.size() + scaled_.rows()) + 10; rounds > 0 && work_left_ > 0; --rounds) {
    if (drop_negative()) {
      if (!refine()) return Outcome::gave_up;
      continue;
    }
    const Index worst = worst_violated();
    if (worst < 0) return Outcome::optimal;
    if (const Outcome outcome = add(worst); outcome != Outcome::optimal) return outcome;
    if (!refine()) return Outcome::gave_up;
  }
  return Outcome::gave_up;
}

void RefereeActiveSet::guess(const ExtendedVector& guess_d, const ExtendedVector* guess_lambda) {
  struct Candidate {
    Index row;
    Real weight;
    double order;
  };
  std::vector<Candidate> candidates;
  const double scale = std::max(scaled_.norm_of_free_motion(), scaled_.norm(guess_d));
  for (Index i = 0; i < scaled_.rows(); ++i) {
    if (!scaled_.counts(i)) continue;
    const double norm = scaled_.row_norm[i];
    const double weight = guess_lambda ? (*guess_lambda)[i].hi * norm : 0;
    const double slack = scaled_.unit_slack(i, guess_d);
    if (scaled_.is_equality(i))
      take(i, weight);
    else if (guess_lambda ? weight > slack && weight > 0 : slack <= referee::touched_by_guess * scale)
      candidates.push_back({i, weight, guess_lambda ? -weight : slack});
  }
  equality_rank = rows.rank();
  std::ranges::stable_sort(candidates, {}, &Candidate::order);
  for (const Candidate& it : candidates)
    if (work_left_ > 0) take(it.row, it.weight);
}

// A row that depends on the basis hands its weight to it; where that would turn a multiplier negative, the row whose
// multiplier reaches zero first leaves and this one takes its place.
void RefereeActiveSet::take(Index row, Real weight) {
  OrthogonalRows::Split s = split(row);
  if (s.dependent) {
    const auto [place, step] = first_blocked(-s.alpha);
    const bool all = scaled_.is_equality(row) || weight <= step;
    const Real moved = all ? weight : step;
    for (Index k = 0; k < rows.rank(); ++k) mu_[at(k)] += moved * s.alpha[k];
    if (all) return;
    weight -= moved;
    drop(place);
    s = split(row);
    if (s.dependent) return;
  }
  hold(row, weight, s);
}

void RefereeActiveSet::hold(Index row, Real weight, const OrthogonalRows::Split& s) {
  rows.append(s);
  basis.push_back(row);
  mu_.push_back(weight);
  place_[at(row)] = 1;
}

void RefereeActiveSet::drop(Index place) {
  const auto from = at(place);
  const std::vector<Index> tail(basis.begin() + place + 1, basis.end());
  const std::vector<Real> weight(mu_.begin() + place + 1, mu_.end());
  for (std::size_t k = from; k < basis.size(); ++k) place_[at(basis[k])] = 0;
  basis.resize(from);
  mu_.resize(from);
  rows.truncate(place);
  for (std::size_t k = 0; k < tail.size(); ++k) {
    const OrthogonalRows::Split s = split(tail[k]);
    if (!s.dependent) hold(tail[k], weight[k], s);
  }
}

// With rho = y - G'mu and e = G_A y - h_A the correction is  dmu = R^-1 (Q'rho - R^-T e),  dy = Q (..) - rho.
// False when the residuals do not fall by 1e6: the basis is too ill-conditioned even for FactorReal.
bool RefereeActiveSet::refine() {
  using std::isfinite;
  const Index r = rows.rank();
  d.setZero(scaled_.size());
  lambda.setZero(scaled_.rows());
  Real before = infinity;
  Real scale = std::numeric_limits<double>::min();
  Column e(r);
  for (int round = 0; round < referee::refinements; ++round) {
    const Column rho = scaled_.whiten(scaled_.force_residual(d, lambda));
    for (Index k = 0; k < r; ++k) {
      const Index i = basis[at(k)];
      e[k] = static_cast<Real>(scaled_.slack(i, d)) / scaled_.row_norm[i];
    }
    const Real error = rho.norm() + e.norm();
    if (round == 0) scale = std::max(scale, error);
    if (!isfinite(error)) return false;
    const Column w = rows.Q().transpose() * rho - rows.solve_transposed(e);
    const Column step = rows.solve(w);
    mu_error_ = r > 0 ? step.lpNorm<Eigen::Infinity>() : Real(0);
    const bool stalled = error > before / 2;
    before = std::min(before, error);
    if (error <= referee::refined * scale || stalled) break;
    const Column dy = rows.Q() * w - rho;
    d += scaled_.unwhiten(dy).cast<DoubleDouble>();
    for (Index k = 0; k < r; ++k) {
      const Index i = basis[at(k)];
      lambda[i] += DoubleDouble(step[k] / scaled_.row_norm[i]);
    }
  }
  for (Index k = 0; k < r; ++k) {
    const Index i = basis[at(k)];
    mu_[at(k)] = static_cast<Real>(lambda[i]) * scaled_.row_norm[i];
  }
  return before <= referee::unrefined * scale;
}

bool RefereeActiveSet::drop_negative() {
  using std::abs;
  Real largest = 0, lowest = 0;
  Index place = -1;
  for (Index k = 0; k < rows.rank(); ++k) {
    const Real mu = mu_[at(k)];
    largest = std::max(largest, abs(mu));
    if (k >= equality_rank && mu < lowest) {
      lowest = mu;
      place = k;
    }
  }
  if (place < 0 || lowest >= -std::max(Real(referee::negative * largest), mu_error_)) return false;
  drop(place);
  return true;
}

Index RefereeActiveSet::worst_violated() const {
  Index worst = -1;
  double most = 0;
  for (Index i = 0; i < scaled_.rows(); ++i) {
    if (held(i) || !scaled_.counts(i)) continue;
    const double slack = scaled_.unit_slack(i, d);
    const double violation = scaled_.is_equality(i) ? std::abs(slack) : -slack;
    if (violation > most && violation > referee::violated * scaled_.rounding(i, d)) {
      most = violation;
      worst = i;
    }
  }
  return worst;
}

std::pair<Index, RefereeActiveSet::Real> RefereeActiveSet::first_blocked(const Column& alpha) const {
  std::pair<Index, Real> first{-1, infinity};
  const Real noise = alpha.size() > 0 ? Real(referee::no_coefficient * alpha.lpNorm<Eigen::Infinity>()) : Real(0);
  for (Index k = 0; k < alpha.size(); ++k) {
    if (scaled_.is_equality(basis[at(k)]) || alpha[k] <= noise) continue;
    const Real step = std::max(mu_[at(k)], Real(0)) / alpha[k];
    if (step < first.second) first = {k, step};
  }
  return first;
}

// Goldfarb & Idnani's step 2: walk along mu - t alpha, + t on the new row, until its violation is gone (full step) or
// a multiplier reaches zero (its row leaves). No bound on t: the rows contradict each other.
RefereeActiveSet::Outcome RefereeActiveSet::add(Index row) {
  Real slack = static_cast<Real>(scaled_.slack(row, d)) / scaled_.row_norm[row];
  Real weight = 0;
  while (work_left_ > 0) {
    const OrthogonalRows::Split s = split(row);
    const auto [place, dual_step] = first_blocked(s.alpha);
    const Real full_step = s.dependent || scaled_.is_equality(row) ? infinity : -slack / (s.left * s.left);
    const Real step = std::min(dual_step, full_step);
    if (step == infinity || scaled_.is_equality(row)) {
      store_farkas(row, slack > 0 ? -1 : 1, s.alpha);
      return Outcome::infeasible;
    }
    for (Index k = 0; k < rows.rank(); ++k) mu_[at(k)] -= step * s.alpha[k];
    weight += step;
    if (full_step <= dual_step) {
      hold(row, weight, s);
      return Outcome::optimal;
    }
    if (!s.dependent) slack += step * s.left * s.left;
    drop(place);
  }
  return Outcome::gave_up;
}

void RefereeActiveSet::store_farkas(Index row, Real sign, const Column& alpha) {
  farkas = Vector::Zero(scaled_.rows());
  const auto set = [&](Index i, Real u) {
    if (!scaled_.is_equality(i) && u < 0) u = 0;
    farkas[i] = std::ldexp(static_cast<double>(u / scaled_.row_norm[i]), -scaled_.row_exponent[i]);
  };
  set(row, sign);
  const bool only_equality = scaled_.is_equality(row);
  for (Index k = 0; k < (only_equality ? equality_rank : rows.rank()); ++k) set(basis[at(k)], -sign * alpha[k]);
}

}  // namespace zwang
