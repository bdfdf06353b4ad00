#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/active_set/active_set_refinement.h>
#include <zwang/solvers/common/dropped_rows.h>
#include <zwang/solvers/common/dual_climb.h>
#include <zwang/solvers/common/equality_elimination.h>
#include <zwang/solvers/common/warm_rows.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/linalg/thin_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The dual active-set method of Goldfarb & Idnani, A numerically stable dual method for solving strictly convex
// quadratic programs (1983), on the whitened problem
//
//   minimize 1/2 |y|^2   subject to  G_E y = h_E,  G_I y >= h_I   (unit rows)
//
// for any scalar. The equality rows leave first: y = y_E + N v turns the rest into
//
//   minimize 1/2 |v|^2   subject to  A v >= b,   A = G_I N,  b = h_I - G_I y_E
//
// in n - rank unknowns, which dual_climb.h solves. Everything is done by orthogonal transformations of G; S = G G' is
// never formed, so digits are lost as eps / pivot, not eps / pivot^2.
//
// The answer is then computed afresh from the active set alone (active_set_refinement.h). It does not carry the path's
// rounding, so a warm start gives the digits of a cold one, and it leaves in z an error of eps_wide / pivot instead of
// eps / pivot. Where the mended answer changes a decision (a multiplier turns negative, a resting row
// is violated), the climb goes on from there.
template <class Scalar>
class GoldfarbIdnani {
 public:
  using Wide = Wider<Scalar>;

  Status solve(const BasicProblem<Scalar>& problem, const SolveOptions& options);

  bool sparse = false;  // a sparse QR of the equality rows where it pays
  bool polish = true;   // off: the answer is that of the factors; the refinement only tells its error

  // The answer: n; m; m when infeasible.
  const VectorX<Wide>& z() const { return polish ? refinement_.z : refinement_.first_z; }
  const VectorX<Wide>& lambda() const { return polish ? refinement_.lambda : refinement_.first_lambda; }
  VectorX<Scalar> certificate;
  std::vector<Index> redundant;
  int iterations = 0;
  Index rank = 0;
  Scalar smallest_accepted{1}, largest_rejected{0};
  bool contracted = true;  // the refinement's corrections became negligible

  // Estimate of |z - z*|_M / max(|z_u|_M, |z - z_u|_M): what the refinement still moved, what rounding hides in the
  // residuals of the active rows, amplified by the smallest pivot, and the multipliers that came out negative.
  Scalar error(const BasicProblem<Scalar>& problem) const;

  // `infeasible` with a combination so far from zero, or a contradiction so small, that rounding could be behind it.
  bool proof_in_doubt = false;
  // Whether the rows outside the active set, held against z from the problem's own J and c in the wider scalar, may be
  // violated (by 32 of its epsilon of their terms; on unit rows in Scalar, 8 of Scalar's cannot be told from rounding),
  // or could move z by more than `limit` (relative, as error()) though they are not.
  bool leaves_in_doubt(const BasicProblem<Scalar>& problem, const Scalar& limit);
  // Where the method ended: the whitened rows, and which of them are accepted equality rows and active inequality rows.
  BasicWhitened<Scalar>& whitened() { return whitened_; }
  const std::vector<Index>& accepted_equalities() const { return equality_rows_; }
  const std::vector<Index>& active_inequalities() const { return active_rows_; }

  // What dual_climb.h asks for, on A v >= b.
  Index choose() { return most_violated(); }
  Scalar split(Index p) {
    const Scalar length = updates_.split(A_.col(p));
    auto r = r_.head(updates_.size());
    r = updates_.components();
    updates_.solve(r);
    return length;
  }
  bool is_dependent(const Scalar& length) {
    const bool dependent = !(length > rank_tolerance());
    if (dependent) largest_rejected = std::max(largest_rejected, length);
    return dependent;
  }
  Scalar violation(Index p) const { return std::max(Scalar(0), Scalar(b_[p] - A_.col(p).dot(v_))); }
  bool is_satisfied(Index p, const Scalar& violation) const {
    using std::abs;
    Scalar size = magnitude_[p];
    for (Index j = 0; j < updates_.size(); ++j) size += abs(r_[j]) * magnitude_[active_[j]];
    return violation <= violation_tolerance() * size;
  }
  Blocking<Scalar> blocking() const;
  bool contradicts(Index p, const Scalar& length) { return certify(*problem_, inequalities_[p], Scalar(1), length); }
  void retire(Index p) { state_[p] = retired; }
  void move(const Scalar& step, bool dependent) {
    u_.head(updates_.size()) -= step * r_.head(updates_.size());
    if (!dependent) v_ += step * updates_.remainder();
  }
  void drop(Index j);
  void append(Index p, const Scalar& multiplier, const Scalar&) {
    u_[updates_.size()] = multiplier;
    updates_.append();
    active_.push_back(p);
    state_[p] = active;
    std::replace(state_.begin(), state_.end(), char(retired), char(resting));
  }
  static constexpr bool is_stuck() { return false; }

 private:
  enum State : char { resting, active, retired };

  static Scalar epsilon() { return std::numeric_limits<Scalar>::epsilon(); }
  static Scalar rank_tolerance() { return rounding(tolerances::rank); }
  static Scalar violation_tolerance() { return rounding(tolerances::violation); }
  static Scalar rounding(int epsilons) {
    if constexpr (std::numeric_limits<Scalar>::digits10 > 80) return Scalar(tolerances::hundred_digits);
    return Scalar(epsilons) * epsilon();
  }

  void require_storage(const BasicProblem<Scalar>& problem, const SolveOptions& options);
  bool eliminate_equalities(const BasicProblem<Scalar>& problem);
  void reduce_inequalities();
  void warm_start(const BasicProblem<Scalar>& problem, const WarmStart& warm);
  Index most_violated();
  void refresh();
  bool restore_dual_feasibility();
  bool certify(const BasicProblem<Scalar>& problem, Index row, const Scalar& sign, const Scalar& length);
  void list_active_rows();
  UnitRest<Wide> rest(const BasicProblem<Scalar>& problem, Index i) const {
    return rest_of(problem, whitened_, i, refinement_.z);
  }
  bool solve_active_set(const BasicProblem<Scalar>& problem);
  void refine(const BasicProblem<Scalar>& problem);
  void observe(const BasicProblem<Scalar>& problem, const Observer& observer);
  void measure_margins();

  BasicWhitened<Scalar> whitened_;
  WarmRows warm_rows_;
  EqualityElimination<Scalar> elimination_;
  BasicThinQr<Scalar> updates_;
  ActiveSetRefinement<Scalar> refinement_;
  std::vector<Index> equalities_, inequalities_;    // whitened rows
  std::vector<Index> equality_rows_, active_rows_;  // whitened rows, in the order of the factors
  std::vector<Index> active_;                       // columns of A_, in the order of the factor
  std::vector<char> state_;                         // of the columns of A_
  MatrixX<Scalar> A_;                               // freedom x inequality rows
  VectorX<Scalar> b_, magnitude_, slack_;           // of the inequality rows
  VectorX<Scalar> v_, u_, r_;                       // (v, u); R^-1 Q'a of the entering row a
  VectorX<Scalar> y_E_, x_, w_;                     // padded n; padded n; rank
  RowSum<Scalar> sum_;
  DroppedRows<Scalar> dropped_;
  Scalar y_E_norm_{0};
  Deadline deadline_;
  const BasicProblem<Scalar>* problem_ = nullptr;  // while it is solved
  DenseStorage storage_;
};

template <class Scalar>
Status GoldfarbIdnani<Scalar>::solve(const BasicProblem<Scalar>& p, const SolveOptions& options) {
  deadline_ = Deadline(options.time_limit);
  require_storage(p, options);
  iterations = 0;
  redundant.clear();
  smallest_accepted = Scalar(1);
  largest_rejected = Scalar(0);
  rank = -1;
  proof_in_doubt = false;
  if (!whitened_.build(p, deadline_, options)) return Status::bad_input;
  if (whitened_.conflict >= 0) {
    zero_row_certificate(p, whitened_.conflict, certificate);
    return Status::infeasible;
  }
  problem_ = &p;
  if (!eliminate_equalities(p)) return Status::infeasible;
  reduce_inequalities();
  if (options.warm_start) warm_start(p, *options.warm_start);

  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    const Status status = dual_climb(*this, iterations, options.max_iterations, deadline_, [&] {
      if (options.observe) observe(p, options.observe);
    });
    if (status == Status::infeasible) return status;
    refine(p);
    if (status != Status::solved) return status;
    if (restore_dual_feasibility() && most_violated() < 0) break;
    if (round + 1 == rounds) contracted = false;
  }
  measure_margins();
  return Status::solved;
}

// Reflections, R and N twice; reduced rows; Q and R of the active ones.
template <class Scalar>
void GoldfarbIdnani<Scalar>::require_storage(const BasicProblem<Scalar>& p, const SolveOptions& options) {
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows());
  const auto e = static_cast<double>(std::count(p.kind.begin(), p.kind.end(), RowKind::equality));
  const double f = std::max(n - e, 0.0);
  const double numbers = n * e + std::min(n, e) * e + 2 * n * f + f * (m - e) + 2 * f * f;
  storage_.require(numbers * sizeof(Scalar) / sizeof(double), options);
}

// Equality rows that depend on others are dropped when they hold, and prove the problem infeasible when they do not.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::eliminate_equalities(const BasicProblem<Scalar>& p) {
  using std::abs;
  equalities_.clear();
  inequalities_.clear();
  for (Index i = 0; i < whitened_.rows(); ++i) (whitened_.equality[i] ? equalities_ : inequalities_).push_back(i);
  elimination_.factorize(whitened_.G, equalities_, rank_tolerance(), deadline_, sparse);
  largest_rejected = elimination_.largest_rejected();
  equality_rows_.clear();
  for (const Index k : elimination_.order()) equality_rows_.push_back(equalities_[k]);
  active_.clear();
  active_rows_.clear();

  // The least-norm point of the accepted rows.
  const Index rank = elimination_.rank();
  w_.resize(rank);
  for (Index k = 0; k < rank; ++k) w_[k] = whitened_.h[equality_rows_[k]];
  elimination_.solve_transposed(w_);
  v_.setZero(elimination_.freedom());
  u_.setZero(elimination_.freedom());
  r_.setZero(elimination_.freedom());
  updates_.reset(elimination_.freedom(), elimination_.freedom());
  y_E_.setZero(elimination_.padded_size());
  elimination_.join(w_, v_, y_E_);
  elimination_.rotate_back(y_E_);
  y_E_norm_ = y_E_.norm();
  x_.resize(elimination_.padded_size());

  for (const Index k : elimination_.rejected()) {
    const Index i = equalities_[k];
    const Scalar rest = whitened_.h[i] - whitened_.dot(i, y_E_);
    // A proof takes twice as much, of more terms.
    const bool may_contradict = abs(rest) > violation_tolerance() / Scalar(2) * whitened_.magnitude[i];
    if (may_contradict && certify(p, i, rest < Scalar(0) ? Scalar(-1) : Scalar(1), largest_rejected)) return false;
    redundant.push_back(whitened_.row[i]);
  }
  for (const Index i : whitened_.idle)
    if (p.is_equality(i)) redundant.push_back(i);
  return true;
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::reduce_inequalities() {
  const auto m = static_cast<Index>(inequalities_.size());
  elimination_.reduce(whitened_.G, inequalities_, deadline_, A_);
  b_.resize(m);
  magnitude_.resize(m);
  slack_.resize(m);
  state_.assign(inequalities_.size(), resting);
  for (Index j = 0; j < m; ++j) {
    const Index i = inequalities_[j];
    b_[j] = whitened_.h[i] - whitened_.dot(i, y_E_);
    magnitude_[j] = whitened_.magnitude[i];
  }
}

// Takes in the earlier frame's active rows that are still there and clearly independent; whatever does not fit now is
// dropped again, so a bad guess costs time only.
template <class Scalar>
void GoldfarbIdnani<Scalar>::warm_start(const BasicProblem<Scalar>& p, const WarmStart& warm) {
  for (const Index i : warm_rows_.find(p, whitened_, &warm)) {
    if (updates_.size() == A_.rows()) break;
    const Index j = std::ranges::lower_bound(inequalities_, i) - inequalities_.begin();
    if (!(updates_.split(A_.col(j)) > Scalar(tolerances::warm_share))) continue;
    updates_.append();
    active_.push_back(j);
    state_[j] = active;
  }
  refresh();
  restore_dual_feasibility();
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

// Ties go to the steepest.
template <class Scalar>
Blocking<Scalar> GoldfarbIdnani<Scalar>::blocking() const {
  const Index q = updates_.size();
  const Scalar noise =
      rank_tolerance() * (q > 0 ? std::max(Scalar(1), Scalar(r_.head(q).cwiseAbs().maxCoeff())) : Scalar(1));
  Blocking<Scalar> first{.row = -1, .step = Scalar(0)};
  for (Index j = 0; j < q; ++j) {
    if (!(r_[j] > noise)) continue;
    const Scalar t = u_[j] / r_[j];
    if (first.row < 0 || t < first.step || (t == first.step && r_[j] > r_[first.row])) first = {j, t};
  }
  return first;
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::drop(Index j) {
  state_[active_[j]] = resting;
  updates_.drop(j);
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

// Farkas' vector from a row that the accepted equality rows and the active rows combine to, up to a rest of `length`:
// sign (e_row - combination).
// False when it proves nothing beyond rounding.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::certify(const BasicProblem<Scalar>& p, Index row, const Scalar& sign,
                                     const Scalar& length) {
  using std::abs;
  const Index n = whitened_.size(), q = active_.empty() ? 0 : updates_.size();
  x_.setZero();
  whitened_.add(row, Scalar(1), x_);
  for (Index j = 0; j < q; ++j) whitened_.add(inequalities_[active_[j]], Scalar(-r_[j]), x_);
  elimination_.rotate(x_);
  elimination_.range(x_, w_);
  elimination_.solve(w_);

  Scalar proof = sign * whitened_.h[row], size = whitened_.magnitude[row];
  const auto add = [&](Index i, const Scalar& multiplier) {
    proof -= sign * multiplier * whitened_.h[i];
    size += abs(multiplier) * whitened_.magnitude[i];
  };
  for (Index k = 0; k < elimination_.rank(); ++k) add(equality_rows_[k], w_[k]);
  for (Index j = 0; j < q; ++j) add(inequalities_[active_[j]], r_[j]);
  if (!(proof > violation_tolerance() * size)) return false;

  // Any motion that met the rows would be at least proof / length long: out_of_reach times the longest one here
  // stands for none.
  // A rest that rounding of the rows does not explain is a direction in which they can be met, however far away.
  const Scalar reach = std::max(Scalar(1), whitened_.free.norm());
  Scalar weight(1);
  for (Index k = 0; k < elimination_.rank(); ++k) weight += abs(w_[k]);
  for (Index j = 0; j < q; ++j) weight += abs(r_[j]);
  list_active_rows();

  certificate.setZero(p.rows());
  const Scalar shortest = whitened_.row_norm.minCoeff();
  const auto write = [&](Index i, const Scalar& unit) {
    certificate[whitened_.row[i]] = unit * (shortest / whitened_.row_norm[i]);
  };
  write(row, sign);
  for (Index k = 0; k < elimination_.rank(); ++k) write(equality_rows_[k], -sign * w_[k]);
  for (Index j = 0; j < q; ++j) write(inequalities_[active_[j]], std::max(Scalar(0), Scalar(-r_[j])));
  // Between near-parallel rows multipliers are long, and their rounding leaves a rest of its own.
  sum_.reset(n);
  for (Index i = 0; i < p.rows(); ++i)
    if (certificate[i] != Scalar(0)) sum_.add(p, i, Wide(certificate[i]) / Wide(shortest));
  const Scalar rest = std::max(length, sum_.length(whitened_)) + violation_tolerance();
  proof_in_doubt = proof < Scalar(tolerances::out_of_reach) * reach * rest ||
                   length > Scalar(tolerances::violation) * epsilon() * weight;
  return true;
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::list_active_rows() {
  active_rows_.clear();
  for (const Index j : active_) active_rows_.push_back(inequalities_[j]);
}

template <class Scalar>
bool GoldfarbIdnani<Scalar>::solve_active_set(const BasicProblem<Scalar>& p) {
  list_active_rows();
  refinement_.keep_first = !polish;
  return refinement_.solve(p, {whitened_, elimination_, updates_, equality_rows_, active_rows_}, deadline_);
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::refine(const BasicProblem<Scalar>& p) {
  contracted = solve_active_set(p);
  v_ = refinement_.v;
  u_.head(updates_.size()) = refinement_.mu.head(updates_.size());
}

// A pivot of 1e-13 harms only where there is rounding to amplify: a four-bar linkage at rest or a wedge whose numbers
// are exact ends with residuals of zero from terms of zero, and z is right to 1e-30.
template <class Scalar>
Scalar GoldfarbIdnani<Scalar>::error(const BasicProblem<Scalar>& p) const {
  using std::sqrt;
  Scalar square(0), negative(0);
  const auto add = [&](Index i) {
    const Scalar hidden = static_cast<Scalar>(Wide(std::numeric_limits<Wide>::epsilon() * rest(p, i).terms));
    square += hidden * hidden;
  };
  for (const Index i : equality_rows_) add(i);
  for (const Index i : active_rows_) add(i);
  for (Index j = 0; j < updates_.size(); ++j) negative = std::max(negative, Scalar(-refinement_.mu[j]));
  const Scalar size = std::max(Scalar(refinement_.y.norm()), Scalar(whitened_.free.norm()));
  if (!(size > Scalar(0))) return Scalar(0);
  const Scalar own = polish ? Scalar(0) : refinement_.first_error;
  return Scalar(
      (own + refinement_.remaining + Scalar(tolerances::pivot_margin) * sqrt(square) / smallest_accepted + negative) /
      size);
}

// A row that is violated by v, or by what rounding hides, and has a share rho outside the active ones would move z by
// v / rho if it were obeyed, unless an active row gives way to it before: after a step of its multiplier by t. That it
// gives way decides nothing where the row is violated by more than its own terms explain.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::leaves_in_doubt(const BasicProblem<Scalar>& p, const Scalar& limit) {
  using std::abs;
  const Wide epsilon = std::numeric_limits<Wide>::epsilon(), length = Wide(refinement_.y.norm());
  const auto violated = [&](const Wide& violation, Index i) {
    return violation > Wide(tolerances::wide_violation) * epsilon * (Wide(whitened_.magnitude[i]) + length);
  };
  const Scalar far = limit * std::max(Scalar(length), Scalar(whitened_.free.norm()));
  for (const Index k : elimination_.rejected())
    if (violated(abs(rest(p, equalities_[k]).violation), equalities_[k])) return true;
  if (dropped_.in_doubt({p, whitened_, elimination_, equalities_, equality_rows_}, refinement_.z, far, deadline_))
    return true;
  for (std::size_t j = 0; j < state_.size(); ++j) {
    if (state_[j] == active) continue;
    const UnitRest<Wide> own = rest(p, inequalities_[j]);
    if (violated(own.violation, inequalities_[j])) return true;
    const Scalar most = static_cast<Scalar>(Wide(own.violation + epsilon * own.terms));
    if (!(most > far * rank_tolerance())) continue;
    deadline_.keep();
    const Scalar rho = split(static_cast<Index>(j));
    if (most <= far * rho) continue;
    if (own.violation > Wide(tolerances::wide_violation) * epsilon * own.terms) return true;
    const Blocking<Scalar> block = blocking();
    if (block.row < 0 || rho * block.step > far) return true;
  }
  return false;
}

// Shows the iterate without touching it, so that an observed solve takes the same path.
template <class Scalar>
void GoldfarbIdnani<Scalar>::observe(const BasicProblem<Scalar>& p, const Observer& observer) {
  solve_active_set(p);
  observer(iterations, z().template cast<double>(), lambda().template cast<double>());
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::measure_margins() {
  rank = elimination_.rank() + updates_.size();
  smallest_accepted = elimination_.smallest_accepted();
  for (Index j = 0; j < updates_.size(); ++j) smallest_accepted = std::min(smallest_accepted, updates_.pivot(j));
  for (std::size_t j = 0; j < state_.size(); ++j)
    if (state_[j] == retired) redundant.push_back(whitened_.row[inequalities_[j]]);
}

}  // namespace zwang
