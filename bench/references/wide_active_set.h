#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/thin_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// A candidate for the truth of a problem without friction, in a scalar wider than those of the solvers: Goldfarb &
// Idnani's method at its plainest (dual_climb.h). Equality rows enter first and stay, all columns are dense, nothing is
// refined and nothing doubted: whoever asks lets a certificate decide what the answer is worth.
template <class Scalar>
class WideActiveSet {
 public:
  // solved, infeasible, or bad_input where M is not positive definite.
  Status solve(const Problem& problem) {
    const BasicProblem<Scalar> p = cast<Scalar>(problem);
    if (!w_.build(p)) return Status::bad_input;
    if (w_.conflict >= 0) {
      zero_row_certificate(p, w_.conflict, certificate);
      return Status::infeasible;
    }
    factor_.reset(w_.size(), w_.rows());
    active_.clear();
    u_.clear();
    state_.assign(w_.equality.size(), resting);
    column_.resize(w_.size());
    int iterations = 0;
    if (!take_equalities() ||
        dual_climb(*this, iterations, std::numeric_limits<int>::max(), Deadline(), [] {}) == Status::infeasible) {
      const VectorX<Scalar> unit = certificate;
      w_.multipliers(p, unit, certificate);
      return Status::infeasible;
    }
    refresh();
    w_.primal(p, y_, z);
    VectorX<Scalar> unit = VectorX<Scalar>::Zero(w_.rows());
    for (std::size_t j = 0; j < active_.size(); ++j) unit[active_[j]] = u_[j];
    w_.multipliers(p, unit, lambda);
    return Status::solved;
  }

  VectorX<Scalar> z, lambda;    // n, m: where solved
  VectorX<Scalar> certificate;  // m: where infeasible

  // What dual_climb.h asks for; rows are those of the whitened problem.

  // The resting row that is violated most on unit rows, or -1.
  Index choose() const {
    const Scalar length = y_.norm();
    Scalar worst(0);
    Index row = -1;
    for (Index i = 0; i < w_.rows(); ++i) {
      if (w_.equality[i] || state_[i] != resting) continue;
      const Scalar own = violation(i);
      if (!(own > worst) || !(own > rounding(tolerances::violation) * (w_.magnitude[i] + length))) continue;
      worst = own;
      row = i;
    }
    return row;
  }
  Scalar split(Index p) {
    column_.setZero();
    w_.add(p, Scalar(1), column_);
    const Scalar length = factor_.split(column_);
    r_ = factor_.components();
    factor_.solve(r_);
    return length;
  }
  static bool is_dependent(const Scalar& length) { return !(length > rounding(tolerances::rank)); }
  Scalar violation(Index p) const { return w_.h[p] - w_.dot(p, y_); }
  bool is_satisfied(Index p, const Scalar& violation) const {
    using std::abs;
    Scalar size = w_.magnitude[p] + y_.norm();
    for (Index j = 0; j < r_.size(); ++j) size += abs(r_[j]) * w_.magnitude[active_[j]];
    return violation <= rounding(tolerances::violation) * size;
  }
  // Ties go to the steepest.
  Blocking<Scalar> blocking() const {
    Blocking<Scalar> first{.row = -1, .step = Scalar(0)};
    const Scalar noise = rounding(tolerances::rank) *
                         (r_.size() > 0 ? std::max(Scalar(1), Scalar(r_.cwiseAbs().maxCoeff())) : Scalar(1));
    for (Index j = 0; j < r_.size(); ++j) {
      if (w_.equality[active_[j]] || !(r_[j] > noise)) continue;
      const Scalar step = u_[j] / r_[j];
      if (first.row < 0 || step < first.step || (step == first.step && r_[j] > r_[first.row])) first = {j, step};
    }
    return first;
  }
  bool contradicts(Index p, const Scalar&) {
    contradict(p, Scalar(1));
    return true;
  }
  void retire(Index p) { state_[p] = retired; }
  void move(const Scalar& step, bool dependent) {
    for (Index j = 0; j < r_.size(); ++j) u_[j] -= step * r_[j];
    if (!dependent) y_ += step * factor_.remainder();
  }
  void drop(Index j) {
    state_[active_[j]] = resting;
    factor_.drop(j);
    active_.erase(active_.begin() + j);
    u_.erase(u_.begin() + j);
  }
  void append(Index p, const Scalar& multiplier, const Scalar&) {
    enter(p);
    u_.push_back(multiplier);
    std::replace(state_.begin(), state_.end(), char(retired), char(resting));
  }
  static constexpr bool is_stuck() { return false; }

 private:
  enum State : char { resting, active, retired };

  static Scalar rounding(int epsilons) {
    if constexpr (std::numeric_limits<Scalar>::digits10 > 80) return Scalar(tolerances::hundred_digits);
    return Scalar(epsilons) * std::numeric_limits<Scalar>::epsilon();
  }
  void enter(Index p) {
    factor_.append();
    active_.push_back(p);
    state_[p] = active;
  }
  // False where one that depends on the others contradicts them.
  bool take_equalities() {
    using std::abs;
    std::vector<Index> dependent;
    for (Index i = 0; i < w_.rows(); ++i) {
      if (!w_.equality[i]) continue;
      if (is_dependent(split(i)))
        dependent.push_back(i);
      else
        enter(i);
    }
    refresh();
    for (const Index i : dependent) {
      split(i);
      const Scalar rest = violation(i);
      if (is_satisfied(i, abs(rest))) continue;
      contradict(i, rest < Scalar(0) ? Scalar(-1) : Scalar(1));
      return false;
    }
    return true;
  }
  // (y, u) afresh from the factor: y = Q R^-T h, u = R^-1 R^-T h.
  void refresh() {
    VectorX<Scalar> u(factor_.size());
    for (Index j = 0; j < u.size(); ++j) u[j] = w_.h[active_[j]];
    factor_.solve_transposed(u);
    y_ = factor_.Q() * u;
    factor_.solve(u);
    u_.assign(u.begin(), u.end());
  }
  // sign (row p - its combination of the active rows), on unit rows, as Farkas' vector.
  void contradict(Index p, const Scalar& sign) {
    certificate.setZero(w_.rows());
    certificate[p] = sign;
    for (Index j = 0; j < r_.size(); ++j) {
      const Scalar part = -sign * r_[j];
      certificate[active_[j]] = w_.equality[active_[j]] ? part : std::max(Scalar(0), part);
    }
  }

  BasicWhitened<Scalar> w_;
  BasicThinQr<Scalar> factor_;  // of the active rows
  std::vector<Index> active_;
  std::vector<char> state_;  // of the rows
  std::vector<Scalar> u_;    // multipliers of the active rows
  VectorX<Scalar> y_, r_;    // n; the split row's parts along the active ones
  VectorX<Scalar> column_;   // n
};

}  // namespace zwang
