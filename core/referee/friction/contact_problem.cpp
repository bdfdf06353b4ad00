#include <zwang/core/referee/friction/contact_problem.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/tolerances.h>

namespace zwang {

using referee::exponent_of;

ContactProblem::ContactProblem(const Problem& problem, const ScaledProblem& scaled, double motion_scale)
    : M(scaled.M), J(scaled.J), h_error(Vector::Zero(scaled.rows())), row_norm(scaled.row_norm), scaled_(&scaled) {
  const Index n = scaled.size(), m = scaled.rows();
  shift = exponent_of(motion_scale);
  column_shift_.resize(n);
  row_shift_.resize(m);
  const Vector mass = M.diagonal();
  for (Index j = 0; j < n; ++j) column_shift_[j] = exponent_of(mass[j]) / 2;

  // Blocks: in the problem's units all rows of a contact share one power of two.
  for (Index i = 0; i < m; ++i) {
    const int own = scaled.row_exponent[i];
    if (problem.is_equality(i)) {
      row_shift_[i] = exponent_of(row_norm[i]);
      if (!scaled.is_zero(i))
        equalities.push_back(i);
      else if (!scaled.zero_row_holds(i))
        fixed_contradiction = true;
      continue;
    }
    const Index tangents = problem.has_tangents() ? problem.tangents(i) : 0;
    ContactRows contact{.row = i, .tangents = tangents, .mu = tangents > 0 ? problem.mu[i] : 0};
    int block = row_norm[i] > 0 ? exponent_of(row_norm[i]) + own : std::numeric_limits<int>::min();
    if (row_norm[i] == 0)
      for (Index t = 1; t < contact.rows(); ++t)
        if (row_norm[i + t] > 0) block = std::max(block, exponent_of(row_norm[i + t]) + scaled.row_exponent[i + t]);
    if (block == std::numeric_limits<int>::min()) {
      contact.unit = 0;
      block = own;
    }
    for (Index t = 0; t <= tangents; ++t) row_shift_[i + t] = block - scaled.row_exponent[i + t];
    if (!scaled.is_vacuous(i)) contacts.push_back(contact);
    i += tangents;
  }

  const auto move = [&](double& x, int e) {
    const double moved = std::ldexp(x, e);
    exact &= x == 0 || (moved != 0 && referee::ordinary(moved));
    x = moved;
  };
  for (Index j = 0; j < n; ++j)
    for (decltype(M)::InnerIterator it(M, j); it; ++it)
      move(it.valueRef(), -column_shift_[j] - column_shift_[it.row()]);
  h.setZero(m);
  z_u = scaled.z_u;
  for (Index j = 0; j < n; ++j) z_u[j] = std::ldexp(z_u[j], column_shift_[j] - shift);
  c = scaled.c;
  for (Index i = 0; i < m; ++i) {
    const int e = row_shift_[i];
    double sum = std::abs(scaled.c[i]);
    Index terms = 1;
    for (decltype(J)::InnerIterator it(J, i); it; ++it, ++terms) {
      sum += std::abs(it.value() * scaled.z_u[it.col()]);
      move(it.valueRef(), -e - column_shift_[it.col()]);
    }
    row_norm[i] = std::ldexp(row_norm[i], -e);
    if (scaled.is_vacuous(i) || !std::isfinite(scaled.c[i])) continue;  // the latter of zeros
    c[i] = std::ldexp(c[i], -e - shift);
    h[i] = scaled.violation(i).scaled(-e - shift);
    h_error[i] = std::ldexp(referee::rounding_of(terms) * sum, -e - shift) + referee::underflow;
    if (!std::isfinite(h_error[i])) exact = false;
  }
  for (ContactRows& contact : contacts) {
    if (contact.unit == 0) continue;
    contact.unit = row_norm[contact.row];
    if (contact.unit == 0)
      for (Index t = 1; t < contact.rows(); ++t) contact.unit = std::max(contact.unit, row_norm[contact.row + t]);
  }
  free_motion = from_norm(scaled.norm_of_free_motion());
  scale = from_norm(motion_scale);
}

ExtendedVector ContactProblem::motion(const Vector& z) const {
  return referee::scaled(scaled_->motion(z), column_shift_ - shift);
}

Vector ContactProblem::rounded_motion(const ExtendedVector& x) const {
  return scaled_->rounded_motion(referee::scaled(x, shift - column_shift_));
}

ExtendedVector ContactProblem::multipliers(const Vector& lambda) const {
  const ExtendedVector own = referee::scaled(scaled_->multipliers(lambda), row_shift_ - shift);
  ExtendedVector l = ExtendedVector::Zero(lambda.size());
  for (const Index i : equalities) l[i] = own[i];
  for (const ContactRows& contact : contacts)
    l.segment(contact.row, 1 + contact.tangents) = own.segment(contact.row, 1 + contact.tangents);
  return l;
}

ExtendedVector ContactProblem::to_multipliers(const ExtendedVector& lambda) const {
  return scaled_->to_multipliers(referee::scaled(lambda, shift - row_shift_));
}

double ContactProblem::length(const ExtendedVector& x) const {
  return from_norm(scaled_->norm_with_free_motion(referee::scaled(x, shift - column_shift_)));
}

double ContactProblem::least_motion(double length) const {
  return std::max({free_motion, length, from_norm(scaled_->least_scale())});
}

int ContactProblem::block_exponent(Index row) const { return row_shift_[row] + scaled_->row_exponent[row]; }

DoubleDouble ContactProblem::slack(Index row, const ExtendedVector& x) const {
  DoubleDouble sum = -h[row];
  for (decltype(J)::InnerIterator it(J, row); it; ++it) sum += DoubleDouble(it.value()) * x[it.col()];
  return sum;
}

double ContactProblem::slack_error(Index row, const ExtendedVector& x) const {
  double sum = std::abs(h[row].hi);
  Index terms = 1;
  for (decltype(J)::InnerIterator it(J, row); it; ++it, ++terms) sum += std::abs(it.value() * x[it.col()].hi);
  return h_error[row] + referee::rounding_of(terms) * sum;
}

double ContactProblem::reach(Index row, const Vector& radius) const { return J.row(row).cwiseAbs().dot(radius); }

void ContactProblem::add_push(Index row, double most, Vector& force) const {
  for (decltype(J)::InnerIterator it(J, row); it; ++it) force[it.col()] += std::abs(it.value()) * most;
}

DoubleDouble ContactProblem::slip(const ContactRows& contact, const ExtendedVector& x) const {
  if (contact.rows() == 1) return {};
  if (contact.rows() == 2) return abs(slack(contact.row + 1, x));
  const DoubleDouble a = slack(contact.row + 1, x), b = slack(contact.row + 2, x);
  return sqrt(a * a + b * b);
}

double ContactProblem::slip_error(const ContactRows& contact, const ExtendedVector& x) const {
  double sum = 0;
  for (Index t = 1; t < contact.rows(); ++t) sum += slack_error(contact.row + t, x);
  return sum + referee::rounding_of_few * slip(contact, x).hi + referee::underflow_of_squares;
}

ExtendedVector ContactProblem::force_residual(const ExtendedVector& x, const ExtendedVector& lambda) const {
  return referee::force_residual(M, J, x, lambda);
}

Vector ContactProblem::force_error(const ExtendedVector& x, const ExtendedVector& lambda) const {
  return referee::force_rounding(M, J, x, lambda).array() + referee::underflow;
}

double ContactProblem::norm(const ExtendedVector& x) const {
  return std::sqrt(std::max(0.0, force_residual(x, {}).dot(x).hi));
}

double ContactProblem::norm_bound(const Vector& radius) const {
  double sum = 0;
  for (Index j = 0; j < M.outerSize(); ++j)
    for (decltype(M)::InnerIterator it(M, j); it; ++it) sum += radius[it.row()] * std::abs(it.value()) * radius[j];
  return referee::up(std::sqrt(sum));
}

// |r|_(M^-1) <= sqrt(sum bound_j^2 / (least eigenvalue of M)) would be too large by the condition of M: each entry
// apart, |r| <= sum_j bound_j |e_j|, with |e_j| taken from the factor once.
double ContactProblem::dual_norm(const Vector& bound) const {
  double sum = 0;
  if (bound.size() == 0 || bound.maxCoeff() == 0) return 0;
  if (unit_norm_.size() == 0) {
    unit_norm_.resize(size());
    for (Index j = 0; j < size(); ++j) unit_norm_[j] = dual_norm(ExtendedVector(ExtendedVector::Unit(size(), j)));
  }
  for (Index j = 0; j < size(); ++j) sum += bound[j] * unit_norm_[j];
  return referee::up(sum);
}

// With M' = D^-1 M D^-1, |r'|_(M'^-1) = |D r'|_(M^-1), D = 2^column_shift.
double ContactProblem::dual_norm(const ExtendedVector& r) const {
  return referee::up(scaled_->dual_norm(referee::scaled(r, column_shift_)));
}

VectorX<FactorReal> ContactProblem::whitened_row(Index row) const {
  ExtendedVector entries = ExtendedVector::Zero(size());
  for (decltype(J)::InnerIterator it(J, row); it; ++it)
    entries[it.col()] = std::ldexp(it.value(), column_shift_[it.col()]);
  return scaled_->whiten(entries);
}

ExtendedVector ContactProblem::motion_by(const ExtendedVector& lambda, int rounds) const {
  ExtendedVector x = ExtendedVector::Zero(size());
  for (int round = 0; round < rounds; ++round) {
    const ExtendedVector force = referee::scaled(force_residual(x, lambda), column_shift_);
    x -= referee::scaled(scaled_->unwhiten(scaled_->whiten(force)).cast<DoubleDouble>(), column_shift_);
  }
  return x;
}

}  // namespace zwang
