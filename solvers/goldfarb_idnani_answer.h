#pragma once

#include "solvers/goldfarb_idnani.h"

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
  const Scalar reach = std::max(Scalar(1), whitened_.free.norm());
  proof_in_doubt = proof < Scalar(2e8) * reach * (length + violation_tolerance());
  list_active_rows();

  certificate.setZero(p.rows());
  const Scalar shortest = whitened_.row_norm.minCoeff();
  const auto write = [&](Index i, const Scalar& unit) {
    certificate[whitened_.row[i]] = unit * (shortest / whitened_.row_norm[i]);
  };
  write(row, sign);
  for (Index k = 0; k < elimination_.rank(); ++k) write(equality_rows_[k], -sign * w_[k]);
  for (Index j = 0; j < q; ++j) write(inequalities_[active_[j]], std::max(Scalar(0), Scalar(-r_[j])));
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
  return refinement_.solve(p, {whitened_, elimination_, updates_, equality_rows_, active_rows_});
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::refine(const BasicProblem<Scalar>& p) {
  contracted = solve_active_set(p);
  v_ = refinement_.v;
  u_.head(updates_.size()) = refinement_.mu.head(updates_.size());
}

template <class Scalar>
auto GoldfarbIdnani<Scalar>::worst_left(const BasicProblem<Scalar>& p) const -> Wide {
  using std::abs, std::ldexp;
  const Wide length = Wide(refinement_.y.norm());
  Wide worst(0);
  const auto visit = [&](Index i) {
    Wide rest(p.c[whitened_.row[i]]);
    for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, whitened_.row[i]); it; ++it)
      rest -= Wide(it.value()) * z()[it.col()];
    if (whitened_.equality[i]) rest = abs(rest);
    const Wide unit = ldexp(Wide(rest / Wide(whitened_.row_norm[i])), -whitened_.exponent);
    worst = std::max(worst, Wide(unit / (Wide(whitened_.magnitude[i]) + length)));
  };
  for (const Index k : elimination_.rejected()) visit(equalities_[k]);
  for (std::size_t j = 0; j < state_.size(); ++j)
    if (state_[j] != active) visit(inequalities_[j]);
  return worst;
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
