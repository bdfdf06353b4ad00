#include <zwang/core/referee/certificate.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

struct Weighted {
  double distance = 0;
  ExtendedVector residual;  // J'u
};

Weighted weigh(const ScaledProblem& scaled, const ExtendedVector& u) {
  const ExtendedVector still = ExtendedVector::Zero(scaled.size());
  Weighted w{.residual = -scaled.force_residual(still, u)};
  DoubleDouble gain;
  double sizes = 0;
  for (Index i = 0; i < scaled.rows(); ++i) {
    const DoubleDouble part = u[i];
    if (part == DoubleDouble(0)) continue;
    gain += scaled.h[i] * part;
    double terms = std::abs(scaled.c[i]);
    for (RowMatrix::InnerIterator it(scaled.J, i); it; ++it) terms += std::abs(it.value() * scaled.z_u[it.col()]);
    sizes += std::abs(part.hi) * terms;
  }
  const double norm = scaled.dual_norm(w.residual);
  // A gain that may be rounding proves nothing, nor does a residual count below its rounding.
  if (!(gain.hi > (norm > 0 ? referee::rounding : referee::no_gain) * sizes))
    w.distance = 0;
  else
    w.distance = norm > 0 ? gain.hi / std::max(norm, scaled.force_rounding(still, u)) : infinity;
  return w;
}

// Moves u, on its own rows, to where J'u vanishes: minimum-norm corrections on unit rows by a complete orthogonal
// factorization in double, residuals in double-double. Returns false when the matrix would be too large.
bool project(const ScaledProblem& scaled, const std::vector<Index>& support, ExtendedVector& u) {
  std::vector<Index> column(at(scaled.size()), -1);
  Index columns = 0;
  for (const Index i : support)
    for (RowMatrix::InnerIterator it(scaled.J, i); it; ++it)
      if (Index& k = column[at(it.col())]; k < 0) k = columns++;
  const auto count = static_cast<Index>(support.size());
  if (columns == 0 || columns * count > referee::projected_entries) return false;

  Matrix A = Matrix::Zero(columns, count);
  for (Index k = 0; k < count; ++k) {
    const Index i = support[at(k)];
    for (RowMatrix::InnerIterator it(scaled.J, i); it; ++it)
      A(column[at(it.col())], k) += it.value() / scaled.row_norm[i];
  }
  Eigen::CompleteOrthogonalDecomposition<Matrix> factor;
  factor.setThreshold(referee::projection_pivot);
  factor.compute(A);
  Vector r(columns);
  for (int round = 0; round < referee::projections; ++round) {
    const ExtendedVector residual = weigh(scaled, u).residual;
    for (Index j = 0; j < residual.size(); ++j)
      if (const Index k = column[at(j)]; k >= 0) r[k] = residual[j].hi;
    const Vector step = factor.solve(r);
    for (Index k = 0; k < count; ++k) {
      const Index i = support[at(k)];
      u[i] -= step[k] / scaled.row_norm[i];
    }
  }
  return true;
}

// In the problem's units |u_t| <= mu u_n: rows of a contact may differ by powers of two here.
bool in_cone(const ScaledProblem& scaled, const ExtendedVector& u, const Problem& p, Index i) {
  const auto part = [&](Index row) { return u[row].scaled(scaled.row_exponent[i] - scaled.row_exponent[row]); };
  DoubleDouble squares;
  for (Index t = 1; t <= p.tangents(i); ++t) squares += part(i + t) * part(i + t);
  const double mu = p.tangents(i) > 0 ? p.mu[i] : 0;
  return part(i).hi >= 0 &&
         (squares == DoubleDouble(0) || sqrt(squares) * (1 + 2 * referee::unit_roundoff) <= part(i) * mu);
}

// The part of u on normal and equality rows, for Coulomb's law; for the convex law u moved into K.
Vector moved_into_cones(const Problem& problem, Vector u) {
  for (Index i = 0; i < u.size(); ++i) {
    if (problem.is_equality(i)) continue;
    const Index tangents = problem.tangents(i);
    const double mu = !referee::slip_lifts(problem.law) && tangents > 0 ? problem.mu[i] : 0;
    const double most = mu * std::max(0.0, u[i]) * (1 - 8 * referee::unit_roundoff);
    double tangential = 0;
    for (Index t = 1; t <= tangents; ++t) tangential = std::hypot(tangential, u[i + t]);
    for (Index t = 1; t <= tangents; ++t)
      if (tangential > most) u[i + t] *= most > 0 ? most / tangential * (1 - 8 * referee::unit_roundoff) : 0;
    i += tangents;
  }
  return u;
}

bool sign_holds(const ScaledProblem& scaled, const ExtendedVector& u, const Problem* cones) {
  if (cones) {
    for (Index i = 0; i < scaled.rows(); ++i)
      if (!cones->is_equality(i) && !cones->is_tangent(i) && !in_cone(scaled, u, *cones, i)) return false;
    return true;
  }
  for (Index i = 0; i < scaled.rows(); ++i)
    if (!scaled.is_equality(i) && u[i].hi < 0) return false;
  return true;
}

}  // namespace

Farkas judge_certificate(const ScaledProblem& scaled, const Vector& certificate, double motion_scale,
                         const Problem* cones) {
  Farkas out;
  const Index m = scaled.rows();
  if (certificate.size() != m || !certificate.allFinite() || m == 0) return out;
  const Vector given = cones ? moved_into_cones(*cones, certificate) : certificate;

  // u in scaled row units, its largest unit-row weight near 1; a zero row counts with weight |u_i|.
  Vector weight(m);
  const auto unit = [&](Index i) { return scaled.is_zero(i) ? 1.0 : scaled.row_norm[i]; };
  int top = std::numeric_limits<int>::min();
  for (Index i = 0; i < m; ++i) {
    int e = 0;
    (void)std::frexp(given[i], &e);
    if (given[i] != 0) top = std::max(top, e + scaled.row_exponent[i]);
  }
  if (top == std::numeric_limits<int>::min()) return out;
  ExtendedVector u(m);
  for (Index i = 0; i < m; ++i) {
    u[i] = std::ldexp(given[i], scaled.row_exponent[i] - top);
    weight[i] = std::abs(u[i].hi) * unit(i);
    if (given[i] != 0 && scaled.is_vacuous(i)) return out;
  }

  const double heaviest = weight.maxCoeff();
  // The motion that rows with any part ask for, for u as it is; and those with a real part, for u moved on them alone.
  double whole = motion_scale, scale = motion_scale;
  for (Index i = 0; i < m; ++i) {
    const double asks = scaled.is_zero(i) ? 0 : std::abs(scaled.h[i].hi) / scaled.row_norm[i];
    if (given[i] != 0) whole = std::max(whole, asks);
    if (weight[i] <= referee::no_part * heaviest) continue;
    out.conflicting.push_back(i);
    scale = std::max(scale, asks);
  }
  std::ranges::stable_sort(out.conflicting, [&](Index a, Index b) { return weight[a] > weight[b]; });

  if (sign_holds(scaled, u, cones)) out.distance = weigh(scaled, u).distance;
  out.proven = out.distance >= referee::farkas_margin * whole;
  ExtendedVector moved = ExtendedVector::Zero(m);
  for (const Index i : out.conflicting) moved[i] = u[i];
  if (out.distance != infinity && project(scaled, out.conflicting, moved) && sign_holds(scaled, moved, cones)) {
    const double distance = weigh(scaled, moved).distance;
    out.distance = std::max(std::isnan(out.distance) ? 0 : out.distance, distance);
    out.proven = out.proven || distance >= referee::farkas_margin * scale;
  }
  return out;
}

}  // namespace zwang
