#include <zwang/core/referee/friction/contact_problem.h>

#include <algorithm>
#include <cmath>

namespace zwang {

using referee::exponent_of;

ContactProblem::ContactProblem(const Problem& problem, const ScaledProblem& scaled, double motion_scale)
    : ScaledProblem(scaled), h_error(Vector::Zero(scaled.rows())) {
  const Index n = size(), m = rows();
  const int shift = exponent_of(motion_scale);
  Eigen::ArrayXi row_shift(m);
  const Vector mass = M.diagonal();
  for (Index j = 0; j < n; ++j) column_exponent[j] = exponent_of(mass[j]) / 2;

  // Blocks: in the problem's units all rows of a contact share one power of two.
  for (Index i = 0; i < m; ++i) {
    const int own = row_exponent[i];
    if (problem.is_equality(i)) {
      row_shift[i] = exponent_of(row_norm[i]);
      if (!is_zero(i))
        equalities.push_back(i);
      else if (!zero_row_holds(i))
        fixed_contradiction = true;
      continue;
    }
    const Index tangents = problem.has_tangents() ? problem.tangents(i) : 0;
    ContactRows contact{.row = i, .tangents = tangents, .mu = tangents > 0 ? problem.mu[i] : 0};
    int block = row_norm[i] > 0 ? exponent_of(row_norm[i]) + own : std::numeric_limits<int>::min();
    if (row_norm[i] == 0)
      for (Index t = 1; t < contact.rows(); ++t)
        if (row_norm[i + t] > 0) block = std::max(block, exponent_of(row_norm[i + t]) + row_exponent[i + t]);
    if (block == std::numeric_limits<int>::min()) {
      contact.unit = 0;
      block = own;
    }
    for (Index t = 0; t <= tangents; ++t) row_shift[i + t] = block - row_exponent[i + t];
    if (!is_vacuous(i)) contacts.push_back(contact);
    i += tangents;
  }

  const auto move = [&](double& x, int e) {
    const double moved = std::ldexp(x, e);
    exact &= x == 0 || (moved != 0 && referee::ordinary(moved));
    x = moved;
  };
  for (Index j = 0; j < n; ++j)
    for (decltype(M)::InnerIterator it(M, j); it; ++it)
      move(it.valueRef(), -column_exponent[j] - column_exponent[it.row()]);
  for (Index j = 0; j < n; ++j) {
    z_u[j] = std::ldexp(z_u[j], column_exponent[j] - shift);
    keeps_motion &= (z_u[j] == 0) == (scaled.z_u[j] == 0);
  }
  for (Index i = 0; i < m; ++i) {
    const int e = row_shift[i];
    double sum = std::abs(scaled.c[i]);
    Index terms = 1;
    for (decltype(J)::InnerIterator it(J, i); it; ++it, ++terms) {
      sum += std::abs(it.value() * scaled.z_u[it.col()]);
      move(it.valueRef(), -e - column_exponent[it.col()]);
    }
    row_norm[i] = std::ldexp(row_norm[i], -e);
    row_exponent[i] += e;
    if (!std::isfinite(scaled.c[i])) continue;
    c[i] = std::ldexp(c[i], -e - shift);
    h[i] = h[i].scaled(-e - shift);
    h_error[i] = std::ldexp(referee::rounding_of(terms) * sum, -e - shift) + referee::underflow;
    if (!std::isfinite(h_error[i])) exact = false;
  }
  for (ContactRows& contact : contacts) {
    if (contact.unit == 0) continue;
    contact.unit = row_norm[contact.row];
    if (contact.unit == 0)
      for (Index t = 1; t < contact.rows(); ++t) contact.unit = std::max(contact.unit, row_norm[contact.row + t]);
  }
  motion_exponent += shift;
  scale = std::ldexp(motion_scale, -shift);
}

ExtendedVector ContactProblem::multipliers(const Vector& lambda) const {
  const ExtendedVector own = ScaledProblem::multipliers(lambda);
  ExtendedVector l = ExtendedVector::Zero(lambda.size());
  for (const Index i : equalities) l[i] = own[i];
  for (const ContactRows& contact : contacts)
    l.segment(contact.row, 1 + contact.tangents) = own.segment(contact.row, 1 + contact.tangents);
  return l;
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

Vector ContactProblem::force_error(const ExtendedVector& x, const ExtendedVector& lambda) const {
  return force_roundings(x, lambda).array() + referee::underflow;
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

ExtendedVector ContactProblem::motion_by(const ExtendedVector& lambda, int rounds) const {
  ExtendedVector x = ExtendedVector::Zero(size());
  for (int round = 0; round < rounds; ++round) x -= unwhiten(whiten(force_residual(x, lambda))).cast<DoubleDouble>();
  return x;
}

}  // namespace zwang
