#include <zwang/core/referee/certificate.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace zwang {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double far_away = 1e8;          // in motion scales: farther than any z that doubles can hold to 1e-8
constexpr double no_part = 1e-10;         // of the largest |u_i| |G_i|: below it a row has no part in the conflict
constexpr Index largest_dense = 4000000;  // entries of the matrix that the projection factorizes

struct Weighted {
  double distance = 0;
  ExtendedVector residual;  // J'u
};

Weighted weigh(const ScaledProblem& gauge, const ExtendedVector& u) {
  Weighted w{.residual = gauge.force_residual(ExtendedVector(static_cast<std::size_t>(gauge.size())), u)};
  for (DoubleDouble& r : w.residual) r = -r;
  DoubleDouble gain;
  for (Index i = 0; i < gauge.rows(); ++i) {
    const DoubleDouble part = u[static_cast<std::size_t>(i)];
    if (!(part == DoubleDouble(0))) gain += gauge.violation(i) * part;
  }
  const double norm = gauge.dual_norm(w.residual);
  w.distance = !(gain.hi > 0) ? 0 : norm > 0 ? gain.hi / norm : infinity;
  return w;
}

// Moves u, on its own rows, to where J'u vanishes: minimum-norm corrections on unit rows by a complete orthogonal
// factorization in double, residuals in double-double. Returns false when the matrix would be too large.
bool project(const ScaledProblem& gauge, const std::vector<Index>& support, ExtendedVector& u) {
  std::vector<Index> column(static_cast<std::size_t>(gauge.size()), -1);
  Index columns = 0;
  for (const Index i : support)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(gauge.J, i); it; ++it)
      if (Index& k = column[static_cast<std::size_t>(it.col())]; k < 0) k = columns++;
  const auto count = static_cast<Index>(support.size());
  if (columns == 0 || columns * count > largest_dense) return false;

  Matrix A = Matrix::Zero(columns, count);
  for (Index k = 0; k < count; ++k) {
    const Index i = support[static_cast<std::size_t>(k)];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(gauge.J, i); it; ++it)
      A(column[static_cast<std::size_t>(it.col())], k) += it.value() / gauge.row_norm[i];
  }
  Eigen::CompleteOrthogonalDecomposition<Matrix> factor;
  factor.setThreshold(1e-12);
  factor.compute(A);
  Vector r(columns);
  for (int round = 0; round < 4; ++round) {
    const ExtendedVector residual = weigh(gauge, u).residual;
    for (std::size_t j = 0; j < column.size(); ++j)
      if (column[j] >= 0) r[column[j]] = residual[j].hi;
    const Vector step = factor.solve(r);
    for (Index k = 0; k < count; ++k) {
      const Index i = support[static_cast<std::size_t>(k)];
      u[static_cast<std::size_t>(i)] -= step[k] / gauge.row_norm[i];
    }
  }
  return true;
}

bool sign_holds(const ScaledProblem& gauge, const ExtendedVector& u) {
  for (Index i = 0; i < gauge.rows(); ++i)
    if (!gauge.is_equality(i) && u[static_cast<std::size_t>(i)].hi < 0) return false;
  return true;
}

}  // namespace

Farkas judge_certificate(const ScaledProblem& gauge, const Vector& given, double motion_scale) {
  Farkas out;
  const Index m = gauge.rows();
  if (given.size() != m || !given.allFinite() || m == 0) return out;

  // u in the gauge's row units, its largest unit-row weight near 1; a zero row counts with weight |u_i|.
  Vector weight(m);
  const auto unit = [&](Index i) { return gauge.is_zero(i) ? 1.0 : gauge.row_norm[i]; };
  int top = std::numeric_limits<int>::min();
  for (Index i = 0; i < m; ++i) {
    int e = 0;
    (void)std::frexp(given[i], &e);
    if (given[i] != 0) top = std::max(top, e + gauge.row_exponent[static_cast<std::size_t>(i)]);
  }
  if (top == std::numeric_limits<int>::min()) return out;
  ExtendedVector u(static_cast<std::size_t>(m));
  for (Index i = 0; i < m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    u[k] = std::ldexp(given[i], gauge.row_exponent[k] - top);
    weight[i] = std::abs(u[k].hi) * unit(i);
    if (given[i] != 0 && gauge.is_vacuous(i)) return out;
  }

  const double heaviest = weight.maxCoeff();
  double scale = motion_scale;
  for (Index i = 0; i < m; ++i) {
    if (weight[i] <= no_part * heaviest) continue;
    out.conflicting.push_back(i);
    if (!gauge.is_zero(i)) scale = std::max(scale, std::abs(gauge.violation(i).hi) / gauge.row_norm[i]);
  }
  std::stable_sort(out.conflicting.begin(), out.conflicting.end(),
                   [&](Index a, Index b) { return weight[a] > weight[b]; });

  if (sign_holds(gauge, u)) out.distance = weigh(gauge, u).distance;
  ExtendedVector moved(static_cast<std::size_t>(m));
  for (const Index i : out.conflicting) moved[static_cast<std::size_t>(i)] = u[static_cast<std::size_t>(i)];
  if (out.distance != infinity && project(gauge, out.conflicting, moved) && sign_holds(gauge, moved))
    out.distance = std::max(std::isnan(out.distance) ? 0 : out.distance, weigh(gauge, moved).distance);
  out.proven = out.distance >= far_away * scale;
  return out;
}

}  // namespace zwang
