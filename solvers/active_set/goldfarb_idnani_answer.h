#pragma once

#include <zwang/solvers/active_set/goldfarb_idnani.h>

// What Goldfarb & Idnani's method says where the climb ends: the refined point, a proof that there is none, margins.

namespace zwang {

// Farkas' vector from a row that the accepted equality rows and the active rows combine to, up to a rest of `length`:
// sign (e_row - combination).
// False when it proves nothing beyond rounding.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::certify(const BasicProblem<Scalar>& p, Index row, const Scalar& sign,
                                     const Scalar& length) {
  using std::abs;
  const Index n = whitened_.size(), q = active_.empty() ? 0 : updates_.size();
  x_.setZero();
  x_.head(n) = whitened_.Gt.col(row);
  for (Index j = 0; j < q; ++j) x_.head(n) -= r_[j] * whitened_.Gt.col(inequalities_[active_[j]]);
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

  // Any motion that met the rows would be at least proof / length long: 1e8 times the longest one here stands for none.
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
  proof_in_doubt = proof < Scalar(tolerances::out_of_reach) * reach * rest || length > Scalar(8) * epsilon() * weight;
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
  return refinement_.solve(p, {whitened_, elimination_, updates_, equality_rows_, active_rows_}, deadline_);
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::refine(const BasicProblem<Scalar>& p) {
  contracted = solve_active_set(p);
  v_ = refinement_.v;
  u_.head(updates_.size()) = refinement_.mu.head(updates_.size());
}

template <class Scalar>
UnitRest<Scalar> GoldfarbIdnani<Scalar>::rest(const BasicProblem<Scalar>& p, Index i) const {
  return rest_of(p, whitened_, i, z());
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
  constexpr int margin = 4;  // the smallest pivot may be larger than the smallest singular value
  return Scalar((refinement_.remaining + Scalar(margin) * sqrt(square) / smallest_accepted + negative) / size);
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
  if (dropped_.in_doubt({p, whitened_, elimination_, equalities_, equality_rows_}, z(), far, deadline_)) return true;
  for (std::size_t j = 0; j < state_.size(); ++j) {
    if (state_[j] == active) continue;
    const UnitRest<Scalar> own = rest(p, inequalities_[j]);
    if (violated(own.violation, inequalities_[j])) return true;
    const Scalar most = static_cast<Scalar>(Wide(own.violation + epsilon * own.terms));
    if (!(most > far * rank_tolerance())) continue;
    deadline_.keep();
    const Scalar rho = updates_.split(A_.col(static_cast<Index>(j)));
    if (most <= far * rho) continue;
    if (own.violation > Wide(tolerances::wide_violation) * epsilon * own.terms) return true;
    auto r = r_.head(updates_.size());
    r = updates_.components();
    updates_.solve(r);
    Scalar step(0);
    if (blocking(step) < 0 || rho * step > far) return true;
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
  using std::abs;
  rank = elimination_.rank() + updates_.size();
  smallest_accepted = elimination_.smallest_accepted();
  for (Index j = 0; j < updates_.size(); ++j)
    smallest_accepted = std::min(smallest_accepted, Scalar(abs(updates_.pivot(j))));
  for (std::size_t j = 0; j < state_.size(); ++j)
    if (state_[j] == retired) redundant.push_back(whitened_.row[inequalities_[j]]);
}

}  // namespace zwang
