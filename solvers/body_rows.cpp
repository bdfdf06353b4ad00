#include "solvers/body_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang {
namespace {

// Products of three such numbers neither overflow nor vanish.
constexpr double smallest = 0x1p-300, largest = 0x1p300;
bool ordinary(double x) { return x > smallest && x < largest; }
bool ordinary_or_zero(double x) { return x == 0 || ordinary(std::abs(x)); }

// Eight bodies, one a lane: the same entry of eight matrices.
using Pack = Eigen::Array<double, 8, 1>;

}  // namespace

// M = L L' and L^-1 of eight bodies at a time, and L'z_u; a root and a quotient then wait for each other six times in
// eight bodies, not in each.
bool BodyRows::factorize(const Problem& p) {
  free.resize(lanes, bodies());
  for (Index base = 0; base < bodies(); base += lanes) {
    const Index count = std::min(lanes, bodies() - base);
    std::array<std::array<Pack, 6>, 6> L, X;
    std::array<Pack, 6> z, reciprocal;
    for (std::size_t i = 0; i < 6; ++i) {
      z[i].setZero();
      for (std::size_t j = 0; j <= i; ++j) L[i][j].setConstant(i == j);
    }
    for (Index lane = 0; lane < count; ++lane)
      for (Index j = 0; j < 6; ++j) {
        const Index column = 6 * (base + lane) + j;
        if (!ordinary_or_zero(p.z_u[column])) return false;
        z[static_cast<std::size_t>(j)][lane] = p.z_u[column];
        for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, column); it; ++it) {
          const Index i = it.row() - (column - j);
          if (i >= j && i < 6)
            L[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)][lane] = it.value();
          else if ((i < 0 || i >= 6) && it.value() != 0)
            return false;
        }
      }
    for (std::size_t j = 0; j < 6; ++j) {
      Pack d = L[j][j];
      for (std::size_t k = 0; k < j; ++k) d -= L[j][k] * L[j][k];
      if (!(d > smallest && d < largest).all()) return false;
      L[j][j] = d.sqrt();
      reciprocal[j] = 1 / L[j][j];
      for (std::size_t i = j + 1; i < 6; ++i) {
        for (std::size_t k = 0; k < j; ++k) L[i][j] -= L[i][k] * L[j][k];
        L[i][j] *= reciprocal[j];
      }
    }
    for (std::size_t j = 0; j < 6; ++j) {
      z[j] *= L[j][j];
      for (std::size_t i = j + 1; i < 6; ++i) z[j] += L[i][j] * z[i];
      X[j][j] = reciprocal[j];
      for (std::size_t i = j + 1; i < 6; ++i) {
        X[i][j] = L[i][j] * X[j][j];
        for (std::size_t k = j + 1; k < i; ++k) X[i][j] += L[i][k] * X[k][j];
        X[i][j] *= -reciprocal[i];
      }
    }
    for (Index lane = 0; lane < count; ++lane) {
      Block& inverse = L_inverse[static_cast<std::size_t>(base + lane)];
      inverse.setZero();
      auto own = free.col(base + lane);
      own.setZero();
      for (std::size_t j = 0; j < 6; ++j) {
        own[static_cast<Index>(j)] = z[j][lane];
        for (std::size_t i = j; i < 6; ++i) inverse(static_cast<Index>(i), static_cast<Index>(j)) = X[i][j][lane];
      }
    }
  }
  return true;
}

// g = L^-1 J' of both bodies, then a unit row.
bool BodyRows::load_row(const Problem& p, Index i, Index k) {
  const int* column = p.J.innerIndexPtr();
  const double* entry = p.J.valuePtr();
  int e = p.J.outerIndexPtr()[i];
  const int end = p.J.isCompressed() ? p.J.outerIndexPtr()[i + 1] : e + p.J.innerNonZeroPtr()[i];
  double held = 0;
  const auto load_side = [&](Lanes& g) {
    g.setZero();
    while (e < end && entry[e] == 0) ++e;
    if (e == end) return -1;
    const int b = column[e] / 6, first = 6 * b;
    const Block& inverse = L_inverse[static_cast<std::size_t>(b)];
    for (; e < end && column[e] < first + 6; ++e) {
      g += entry[e] * inverse.col(column[e] - first);
      held += entry[e] * p.z_u[column[e]];
    }
    return b;
  };
  Lanes g0, g1;
  auto& at = body[static_cast<std::size_t>(k)];
  at[0] = load_side(g0);
  at[1] = load_side(g1);
  while (e < end && entry[e] == 0) ++e;
  const double norm = std::sqrt((g0.cwiseProduct(g0) + g1.cwiseProduct(g1)).sum());
  if (e < end || !ordinary(norm) || !ordinary_or_zero(p.c[i])) return false;
  const double reciprocal = 1 / norm;
  G.col(2 * k) = g0 * reciprocal;
  G.col(2 * k + 1) = g1 * reciprocal;
  h[k] = (p.c[i] - held) * reciprocal;
  magnitude[k] = std::abs(p.c[i]) * reciprocal;
  row_norm[k] = norm;
  row[static_cast<std::size_t>(k)] = i;
  equality[static_cast<std::size_t>(k)] = p.is_equality(i);
  return true;
}

bool BodyRows::build(const Problem& p) {
  const Index n = p.size(), m = p.rows();
  if (n == 0 || n % 6 != 0) return false;
  L_inverse.resize(static_cast<std::size_t>(n / 6));
  if (!factorize(p)) return false;
  if (G.cols() < 2 * m) G.resize(lanes, 2 * m);
  for (Vector* part : {&h, &row_norm, &magnitude})
    if (part->size() < m) part->resize(m);
  const auto resize_rows = [&](Index count) {
    row.resize(static_cast<std::size_t>(count));
    equality.resize(static_cast<std::size_t>(count));
    body.resize(static_cast<std::size_t>(count));
  };
  resize_rows(m);
  Index count = 0;
  for (Index i = 0; i < m; ++i)
    if (std::isfinite(p.c[i]) && !load_row(p, i, count++)) return false;
  resize_rows(count);

  // The unit of length: the worst violation of z_u.
  double worst = 0;
  for (Index i = 0; i < rows(); ++i)
    worst = std::max(worst, equality[static_cast<std::size_t>(i)] ? std::abs(h[i]) : h[i]);
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
