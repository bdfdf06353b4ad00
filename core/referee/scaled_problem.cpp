#include <zwang/core/referee/scaled_problem.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace referee {

ExtendedVector scaled(const ExtendedVector& x, const Eigen::ArrayXi& exponents) {
  ExtendedVector out(x.size());
  for (Index i = 0; i < x.size(); ++i) out[i] = x[i].scaled(exponents[i]);
  return out;
}

int exponent_of(double x) {
  int e = 0;
  (void)std::frexp(x, &e);
  return e;
}

}  // namespace referee

namespace {

// Sum of squares weighted by 1/D as L^-1 r: forward substitution along the columns that fill in.
template <class Lower>
FactorReal forward_squared(const Lower& L, VectorX<FactorReal>& x, Index first) {
  FactorReal sum = 0;
  for (Index j = first; j < x.size(); ++j) {
    if (x[j] == 0) continue;
    typename Lower::InnerIterator it(L, j);
    const FactorReal value = x[j] / it.value();
    sum += value * value;
    for (++it; it; ++it) x[it.row()] -= it.value() * value;
    x[j] = 0;
  }
  return sum;
}

}  // namespace

using referee::exponent_of;

ScaledProblem::ScaledProblem(const Problem& p)
    : M(p.M), J(p.J), z_u(p.z_u), c(p.c), row_norm(Vector::Zero(p.rows())), stored_c(p.c) {
  const Index n = size(), m = rows();
  M.makeCompressed();
  J.makeCompressed();
  equality.resize(at(m));
  row_exponent.setZero(m);
  column_exponent.setZero(n);

  // No nonzero mass may vanish: a denormal one stays where it is.
  constexpr int least = std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits + 1;
  int heaviest = 0, lightest = std::numeric_limits<double>::max_exponent;
  for (Index k = 0; k < M.nonZeros(); ++k) {
    if (M.valuePtr()[k] == 0) continue;
    const int e = exponent_of(M.valuePtr()[k]);
    heaviest = lightest == std::numeric_limits<double>::max_exponent ? e : std::max(heaviest, e);
    lightest = std::min(lightest, e);
  }
  mass_exponent = std::min(heaviest / 2 * 2, (lightest - least) / 2 * 2);
  for (Index k = 0; k < M.nonZeros(); ++k) M.valuePtr()[k] = std::ldexp(M.valuePtr()[k], -mass_exponent);

  // A motion is as large as z_u or as the rows that may force it; c far below zero on a contact forces nothing.
  // (Its exponent: a row of denormal entries may ask for more than a double holds.)
  std::optional<int> top;
  const auto reach = [&](double x, int shift) {
    if (x > 0) top = std::max(top.value_or(exponent_of(x) + shift), exponent_of(x) + shift);
  };
  reach(n > 0 ? z_u.cwiseAbs().maxCoeff() : 0, 0);
  for (Index i = 0; i < m; ++i) {
    equality[at(i)] = p.is_equality(i);
    const double entry = largest_entry(J, i);
    const int e = row_exponent[i] = exponent_of(entry);
    for (decltype(J)::InnerIterator it(J, i); it; ++it) it.valueRef() = std::ldexp(it.value(), -e);
    if (entry > 0 && std::isfinite(c[i])) reach(p.is_equality(i) || p.is_tangent(i) ? std::abs(c[i]) : c[i], -e);
  }
  motion_exponent = top.value_or(0);
  for (Index i = 0; i < n; ++i) z_u[i] = std::ldexp(z_u[i], -motion_exponent);
  h.setZero(m);
  for (Index i = 0; i < m; ++i) {
    c[i] = std::ldexp(c[i], -row_exponent[i] - motion_exponent);
    if (!std::isfinite(c[i])) continue;
    h[i] = c[i];
    for (decltype(J)::InnerIterator it(J, i); it; ++it) h[i] -= DoubleDouble::exact_product(it.value(), z_u[it.col()]);
  }

  if (n > 0) {
    factor->compute(M.cast<FactorReal>());
    definite = factor->info() == Eigen::Success && proven_definite();
  }
  if (definite) weigh_rows();
}

// The Cholesky factor of A in floating point is that of A + E, |E_ij| <= gamma sqrt(A_ii A_jj) with gamma of the
// longest row of L (Demmel 1989; Rump 2006). So where A - c diag(A) has one, diag(A)^-1/2 A diag(A)^-1/2 has no
// eigenvalue below c - |E|; with c = 2^8 |E| the factor of A itself leaves every dual norm to within 1 %.
bool ScaledProblem::proven_definite() const {
  const Eigen::SparseMatrix<FactorReal> L = factor->matrixL();
  Eigen::VectorXi in_row = Eigen::VectorXi::Zero(size());
  int longest = 0;
  for (Index j = 0; j < L.outerSize(); ++j) {
    int in_column = 0;
    for (Eigen::SparseMatrix<FactorReal>::InnerIterator it(L, j); it; ++it, ++in_column) ++in_row[it.row()];
    longest = std::max(longest, in_column);
  }
  longest = std::max(longest, in_row.maxCoeff());
  if (longest == 1) return true;  // a diagonal M: its factor is that of its entries
  const FactorReal shift =
      FactorReal(256.0 * (longest + 2) * longest) * FactorReal(std::numeric_limits<FactorReal>::epsilon());
  Eigen::SparseMatrix<FactorReal> shifted = M.cast<FactorReal>();
  for (Index j = 0; j < size(); ++j) shifted.coeffRef(j, j) -= shift * FactorReal(M.coeff(j, j));
  return Factor(shifted).info() == Eigen::Success;
}

void ScaledProblem::weigh_rows() {
  if (size() == 0) return;
  using std::sqrt;
  const Eigen::SparseMatrix<FactorReal> L = factor->matrixL();
  const auto& place = factor->permutationP().indices();
  VectorX<FactorReal> x = VectorX<FactorReal>::Zero(size());
  for (Index i = 0; i < rows(); ++i) {
    Index first = size();
    for (decltype(J)::InnerIterator it(J, i); it; ++it) {
      const Index k = place.size() > 0 ? place[it.col()] : it.col();
      x[k] = it.value();
      first = std::min(first, k);
    }
    row_norm[i] = static_cast<double>(sqrt(forward_squared(L, x, first)));
  }
}

Problem ScaledProblem::problem() const {
  Problem p{.M = M, .z_u = z_u, .J = J, .c = c};
  for (const char is : equality) p.kind.push_back(is ? RowKind::equality : RowKind::inequality);
  p.key.resize(p.kind.size());
  return p;
}

ExtendedVector ScaledProblem::motion(const Vector& z) const {
  ExtendedVector d(size());
  for (Index i = 0; i < size(); ++i)
    d[i] = DoubleDouble::exact_sum(std::ldexp(z[i], column_exponent[i] - motion_exponent), -z_u[i]);
  return d;
}

Vector ScaledProblem::rounded_motion(const ExtendedVector& d) const {
  Vector z(size());
  for (Index j = 0; j < z.size(); ++j)
    z[j] = std::ldexp((d[j] + DoubleDouble(z_u[j])).hi, motion_exponent - column_exponent[j]);
  return z;
}

ExtendedVector ScaledProblem::to_multipliers(const ExtendedVector& lambda) const {
  return referee::scaled(lambda, motion_exponent + mass_exponent - row_exponent);
}

ExtendedVector ScaledProblem::motion_of(const ExtendedVector& d) const {
  return referee::scaled(d, column_exponent - motion_exponent);
}

ExtendedVector ScaledProblem::multipliers(ExtendedVector lambda) const {
  for (Index i = 0; i < lambda.size(); ++i)
    lambda[i] = is_vacuous(i) ? DoubleDouble() : lambda[i].scaled(row_exponent[i] - motion_exponent - mass_exponent);
  return lambda;
}

ExtendedVector ScaledProblem::multipliers(const Vector& lambda) const {
  return multipliers(ExtendedVector(lambda.cast<DoubleDouble>()));
}

double ScaledProblem::to_problem_norm(double norm) const { return std::ldexp(norm, norm_exponent()); }

double ScaledProblem::scale_of(double norm) const { return std::max({norm_of_free_motion(), norm, least_scale()}); }

double ScaledProblem::least_scale() const {
  const double scale = std::ldexp(std::numeric_limits<double>::min(), -norm_exponent());
  return std::max(scale, std::numeric_limits<double>::denorm_min());
}

double ScaledProblem::row_scale(Index i) const { return std::ldexp(1.0, row_exponent[i] + motion_exponent); }

double ScaledProblem::norm(const ExtendedVector& d) const {
  using std::sqrt;
  const FactorReal square = force_residual(d, {}).cwiseProduct(d).cast<FactorReal>().sum();
  return static_cast<double>(sqrt(std::max(square, FactorReal(0))));
}

double ScaledProblem::norm_of(const Vector& z) const { return norm(motion_of(z.cast<DoubleDouble>())); }

double ScaledProblem::norm_of_free_motion() const { return norm(z_u.cast<DoubleDouble>()); }

double ScaledProblem::norm_with_free_motion(const ExtendedVector& d) const {
  return norm(d + z_u.cast<DoubleDouble>());
}

VectorX<FactorReal> ScaledProblem::whiten(const ExtendedVector& r) const {
  VectorX<FactorReal> x = referee::scaled(r, column_exponent).cast<FactorReal>();
  if (size() == 0) return x;
  x = factor->permutationP() * x;
  return factor->matrixL().solve(x);
}

VectorX<FactorReal> ScaledProblem::unwhiten(const VectorX<FactorReal>& y) const {
  if (size() == 0) return y;
  VectorX<FactorReal> x = factor->matrixU().solve(y);
  x = factor->permutationPinv() * x;
  for (Index j = 0; j < size(); ++j) x[j] *= FactorReal(std::ldexp(1.0, column_exponent[j]));
  return x;
}

double ScaledProblem::dual_norm(const ExtendedVector& r) const { return static_cast<double>(whiten(r).stableNorm()); }

DoubleDouble ScaledProblem::slack(Index i, const ExtendedVector& d) const {
  DoubleDouble sum = -h[i];
  for (decltype(J)::InnerIterator it(J, i); it; ++it) sum += DoubleDouble(it.value()) * d[it.col()];
  return sum;
}

// The terms as one sum of doubles without overlap, which is zero where each of them is (Shewchuk 1997).
bool ScaledProblem::slack_vanishes(Index i, const ExtendedVector& d) const {
  std::vector<double> sum;
  const auto add = [&](double x) {
    for (double& part : sum) {
      const DoubleDouble both = DoubleDouble::exact_sum(x, part);
      x = both.hi;
      part = both.lo;
    }
    sum.push_back(x);
  };
  add(-c[i]);
  for (decltype(J)::InnerIterator it(J, i); it; ++it) {
    const DoubleDouble& move = d[it.col()];
    for (const double x : {z_u[it.col()], move.hi, move.lo}) {
      const DoubleDouble product = DoubleDouble::exact_product(it.value(), x);
      add(product.hi);
      add(product.lo);
    }
  }
  return std::ranges::all_of(sum, [](double x) { return x == 0; });
}

VectorX<FactorReal> ScaledProblem::whitened_row(Index i) const {
  VectorX<FactorReal> x = VectorX<FactorReal>::Zero(size());
  for (decltype(J)::InnerIterator it(J, i); it; ++it) x[it.col()] = std::ldexp(it.value(), column_exponent[it.col()]);
  x = factor->permutationP() * x;
  return factor->matrixL().solve(x);
}

double ScaledProblem::rounding(Index i, const ExtendedVector& d) const {
  double sum = std::abs(c[i]);
  Index terms = 1;
  for (decltype(J)::InnerIterator it(J, i); it; ++it, ++terms)
    sum += std::abs(it.value()) * (std::abs(z_u[it.col()]) + std::abs(d[it.col()].hi));
  return referee::rounding_of(terms) * sum / row_norm[i] + std::numeric_limits<double>::min();
}

ExtendedVector ScaledProblem::force_residual(const ExtendedVector& d, const ExtendedVector& lambda) const {
  ExtendedVector r = ExtendedVector::Zero(d.size());
  for (Index j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) r[it.row()] += DoubleDouble(it.value()) * d[j];
  for (Index i = 0; i < lambda.size(); ++i) {
    if (lambda[i] == DoubleDouble(0)) continue;
    for (RowMatrix::InnerIterator it(J, i); it; ++it) r[it.col()] -= DoubleDouble(it.value()) * lambda[i];
  }
  return r;
}

Vector ScaledProblem::force_roundings(const ExtendedVector& d, const ExtendedVector& lambda) const {
  Vector sum = Vector::Zero(d.size());
  std::vector<Index> terms(at(d.size()), 0);
  const auto add = [&](Index k, double x) {
    sum[k] += std::abs(x);
    ++terms[at(k)];
  };
  for (Index j = 0; j < M.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(M, j); it; ++it) add(it.row(), it.value() * d[j].hi);
  for (Index i = 0; i < J.rows(); ++i)
    if (const double weight = lambda[i].hi; weight != 0)
      for (RowMatrix::InnerIterator it(J, i); it; ++it) add(it.col(), it.value() * weight);
  for (Index j = 0; j < sum.size(); ++j) sum[j] *= referee::rounding_of(terms[at(j)]);
  return sum;
}

// The dual norm of the entrywise bound; it bounds that of any residual below it when M is diagonal, and stands for it
// within the condition of M's blocks otherwise. 2^-98 leaves 16 bits for that.
double ScaledProblem::force_rounding(const ExtendedVector& d, const ExtendedVector& lambda) const {
  return dual_norm(force_roundings(d, lambda).cast<DoubleDouble>());
}

}  // namespace zwang
