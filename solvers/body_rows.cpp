#include "solvers/body_rows.h"

#include <cmath>
#include <limits>

namespace zwang {
namespace {

// Products of three such numbers neither overflow nor vanish.
constexpr double smallest = 0x1p-300, largest = 0x1p300;
bool ordinary(double x) { return x > smallest && x < largest; }
bool ordinary_or_zero(double x) { return x == 0 || ordinary(std::abs(x)); }

// The inverse of L, A = L L', column by column. False when A is not positive definite.
bool invert_factor(Mat<double, 6, 6>& A, BodyRows::Block& inverse) {
  for (int j = 0; j < 6; ++j) {
    double d = A(j, j);
    for (int k = 0; k < j; ++k) d -= A(j, k) * A(j, k);
    if (!ordinary(d)) return false;
    const double reciprocal = 1 / std::sqrt(d);
    for (int i = j + 1; i < 6; ++i) {
      double a = A(i, j);
      for (int k = 0; k < j; ++k) a -= A(i, k) * A(j, k);
      A(i, j) = a * reciprocal;
    }
    A(j, j) = reciprocal;
  }
  inverse.setZero();
  for (int j = 0; j < 6; ++j) {
    inverse(j, j) = A(j, j);
    for (int i = j + 1; i < 6; ++i) {
      double a = 0;
      for (int k = j; k < i; ++k) a -= A(i, k) * inverse(k, j);
      inverse(i, j) = a * A(i, i);
    }
  }
  return true;
}

}  // namespace

bool BodyRows::factorize(const Problem& p) {
  Mat<double, 6, 6> A;
  for (Index b = 0; b < bodies(); ++b) {
    A.setZero();
    for (Index j = 0; j < 6; ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, 6 * b + j); it; ++it) {
        const Index i = it.row() - 6 * b;
        if (i >= 0 && i < 6)
          A(i, j) = it.value();
        else if (it.value() != 0)
          return false;
      }
    if (!invert_factor(A, L_inverse[static_cast<std::size_t>(b)])) return false;
  }
  return true;
}

// g = L^-1 J' of both bodies, then a unit row.
bool BodyRows::load_row(const Problem& p, Index i) {
  std::array<int, 2> at{-1, -1};
  std::array<Lanes, 2> g{Lanes::Zero(), Lanes::Zero()};
  double held = 0;
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
    const double a = it.value();
    if (a == 0) continue;
    const int b = static_cast<int>(it.col()) / 6, j = static_cast<int>(it.col()) % 6;
    int side = at[1] >= 0 ? 1 : 0;
    if (at[static_cast<std::size_t>(side)] != b) {
      side += at[0] >= 0;
      if (side > 1) return false;
      at[static_cast<std::size_t>(side)] = b;
    }
    g[static_cast<std::size_t>(side)] += a * L_inverse[static_cast<std::size_t>(b)].col(j);
    held += a * p.z_u[it.col()];
  }
  const double norm = std::sqrt(g[0].squaredNorm() + g[1].squaredNorm());
  if (!ordinary(norm) || !ordinary_or_zero(p.c[i])) return false;
  const Index k = rows();
  const double reciprocal = 1 / norm;
  G.col(2 * k) = g[0] * reciprocal;
  G.col(2 * k + 1) = g[1] * reciprocal;
  h[k] = (p.c[i] - held) * reciprocal;
  magnitude[k] = std::abs(p.c[i]) * reciprocal;
  row_norm[k] = norm;
  row.push_back(i);
  equality.push_back(p.is_equality(i));
  body.push_back(at);
  return true;
}

bool BodyRows::build(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  if (n == 0 || n % 6 != 0) return false;
  L_inverse.resize(static_cast<std::size_t>(n / 6));
  if (!factorize(p)) return false;
  row.clear();
  equality.clear();
  body.clear();
  if (G.cols() < 2 * m) G.resize(lanes, 2 * m);
  for (Vector* part : {&h, &row_norm, &magnitude})
    if (part->size() < m) part->resize(m);
  for (Index i = 0; i < m; ++i)
    if (std::isfinite(p.c[i]) && !load_row(p, i)) return false;

  // The unit of length: the worst violation of z_u.
  double worst = 0;
  for (Index i = 0; i < rows(); ++i)
    worst = std::max(worst, equality[static_cast<std::size_t>(i)] ? std::abs(h[i]) : h[i]);
  free.setZero(lanes, bodies());
  for (Index b = 0; b < bodies(); ++b) {
    for (Index j = 0; j < 6; ++j)
      if (!ordinary_or_zero(p.z_u[6 * b + j])) return false;
    // L'z_u by back substitution with the inverse.
    const Block& inverse = L_inverse[static_cast<std::size_t>(b)];
    for (Index j = 6; j-- > 0;) {
      double rest = p.z_u[6 * b + j];
      for (Index i = j + 1; i < 6; ++i) rest -= inverse(i, j) * free(i, b);
      free(j, b) = rest / inverse(j, j);
    }
  }
  free_norm = free.norm();
  if (!ordinary_or_zero(worst) || !ordinary_or_zero(free_norm)) return false;
  exponent = 0;
  (void)std::frexp(worst > 0 ? worst : free_norm, &exponent);
  const double unit = std::ldexp(1.0, -exponent);
  h.head(rows()) *= unit;
  free *= unit;
  free_norm *= unit;
  magnitude.head(rows()) *= unit;
  magnitude.head(rows()).array() += free_norm;
  return true;
}

}  // namespace zwang
