#include <zwang/solvers/active_set/careful_climb.h>

#include <algorithm>
#include <cmath>

namespace zwang {

void CarefulClimb::reset(const Whitened& rows, bool sparse, const Deadline& deadline) {
  w_ = &rows;
  active_.sparse = sparse;
  active_.reset(rows, deadline);
  place_.clear();
  state_.assign(active_.inequalities().size(), resting);
  for (Vector* part : {&v_, &u_, &r_}) part->setZero(active_.freedom());
  slack_.resize(active_.A().cols());
  y_.resize(rows.size());
  rest_.resize(active_.padded_size());
  equality_.resize(active_.rank());
}

void CarefulClimb::warm_start(std::span<const Index> rows) {
  const std::vector<Index>& all = active_.inequalities();
  for (const Index i : rows) {
    if (size() == active_.freedom()) break;
    const Index j = std::ranges::lower_bound(all, i) - all.begin();
    if (active_.qr().split(active_.A().col(j)) > tolerances::warm_share) append(j, 0, 0);
  }
  if (!rows.empty()) restore_dual_feasibility();
}

// (v, u) of the active rows, of which the most negative multiplier leaves until none is left.
void CarefulClimb::restore_dual_feasibility() {
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

void CarefulClimb::locate() {
  active_.lift(v_, y_);
  unit_.setZero(w_->rows());
  rest_.setZero();
  rest_.head(y_.size()) = y_;
  combine(u_, 1);
}

void CarefulClimb::express(Index row, double sign) {
  unit_.setZero(w_->rows());
  unit_[row] = sign;
  rest_.setZero();
  w_->add(row, 1, rest_);
  combine(r_, -sign);
}

// unit_ of the active rows = sign times their parts of rest_, of which `part` is that of the inequality rows.
void CarefulClimb::combine(const Vector& part, double sign) {
  const Index e = active_.rank();
  for (Index j = 0; j < size(); ++j) {
    w_->add(active_[e + j], -part[j], rest_);
    unit_[active_[e + j]] = std::max(0.0, sign * part[j]);
  }
  active_.balance(rest_, equality_);
  for (Index k = 0; k < e; ++k) unit_[active_[k]] = sign * equality_[k];
}

// The resting row that is violated most on unit rows, or -1. Without equality rows v is y, and rows keep their zeros.
Index CarefulClimb::choose() {
  if (active_.rank() == 0)
    slack_.noalias() = w_->G * v_;
  else
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

double CarefulClimb::split(Index j) {
  const double length = active_.qr().split(active_.A().col(j));
  auto r = r_.head(size());
  r = active_.qr().components();
  active_.qr().solve(r);
  return length;
}

bool CarefulClimb::is_satisfied(Index j, double violation) const {
  double terms = magnitude(j);
  for (std::size_t k = 0; k < place_.size(); ++k) terms += std::abs(r_[static_cast<Index>(k)]) * magnitude(place_[k]);
  return violation <= tolerances::violation * epsilon * terms;
}

// Ties go to the steepest.
Blocking<double> CarefulClimb::blocking() const {
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

bool CarefulClimb::contradicts(Index j, double) {
  express(active_.inequalities()[at(j)], 1);
  return true;
}

void CarefulClimb::move(double step, bool dependent) {
  u_.head(size()) -= step * r_.head(size());
  if (!dependent) v_ += step * active_.qr().remainder();
}

void CarefulClimb::drop(Index position) {
  state_[at(place_[at(position)])] = resting;
  active_.drop(active_.rank() + position);
  place_.erase(place_.begin() + position);
  for (Index k = position; k < size(); ++k) u_[k] = u_[k + 1];
}

void CarefulClimb::append(Index j, double multiplier, double) {
  u_[size()] = multiplier;
  active_.accept(j);
  place_.push_back(j);
  state_[at(j)] = held;
  std::replace(state_.begin(), state_.end(), char(retired), char(resting));
}

}  // namespace zwang
