#include <zwang/solvers/form/body_rows.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/preparation.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using lanes::Pack;

// Products of three such numbers neither overflow nor vanish.
constexpr double smallest = 0x1p-300, largest = 0x1p300;
bool ordinary(double x) { return x > smallest && x < largest; }
bool ordinary_or_zero(double x) { return x == 0 || ordinary(std::abs(x)); }

}  // namespace

// M = L L' and L^-1 of eight bodies at a time, and L'z_u; a root and a quotient then wait for each other six times in
// eight bodies, not in each.
bool BodyRows::factorize(const Problem& p) {
  free.resize(lanes, bodies());
  z_u.setZero(lanes, bodies());
  z_u.topRows<6>() = p.z_u.reshaped(6, bodies());
  for (Index base = 0; base < bodies(); base += lanes) {
    const Index count = std::min(lanes, bodies() - base);
    std::array<std::array<Pack, 6>, 6> L, X;
    std::array<Pack, 6> z, reciprocal;
    for (std::size_t i = 0; i < 6; ++i) {
      z[i] = Pack(0);
      for (std::size_t j = 0; j <= i; ++j) L[i][j] = Pack(i == j);
    }
    for (Index lane = 0; lane < count; ++lane)
      for (Index j = 0; j < 6; ++j) {
        const Index column = 6 * (base + lane) + j;
        if (!ordinary_or_zero(p.z_u[column])) return false;
        auto own = M[at(base + lane)].col(j);
        own.setZero();
        z[at(j)].data()[lane] = p.z_u[column];
        for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, column); it; ++it) {
          const Index i = it.row() - (column - j);
          if (i >= 0 && i < 6) own[i] = it.value();
          if (i >= j && i < 6)
            L[at(i)][at(j)].data()[lane] = it.value();
          else if ((i < 0 || i >= 6) && it.value() != 0)
            return false;
        }
      }
    for (std::size_t j = 0; j < 6; ++j) {
      Pack d = L[j][j];
      for (std::size_t k = 0; k < j; ++k) d -= L[j][k] * L[j][k];
      const Eigen::Map<const Eigen::Array<double, lanes, 1>> pivots(d.data());
      if (!(pivots > smallest && pivots < largest).all()) return false;
      L[j][j] = lanes::root(d);
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
      Block& inverse = L_inverse[at(base + lane)];
      Block& transposed = L_inverse_t[at(base + lane)];
      auto own = free.col(base + lane);
      own.setZero();
      for (std::size_t j = 0; j < 6; ++j) {
        own[static_cast<Index>(j)] = z[j].data()[lane];
        for (std::size_t i = j; i < 6; ++i) {
          const auto above = static_cast<Index>(j), below = static_cast<Index>(i);
          inverse(below, above) = transposed(above, below) = X[i][j].data()[lane];
        }
      }
    }
  }
  return true;
}

// J by bodies, G = J L^-T and h = c - J z_u of rows as they stand.
bool BodyRows::load_rows(const Problem& p) {
  const Index m = p.rows();
  row.resize(at(m));
  equality.resize(at(m));
  body.resize(at(m));
  place.resize(at(m));
  if (G.cols() < 2 * m) {
    G.resize(lanes, 2 * m);
    J.resize(lanes, 2 * m);
    for (Vector* part : {&c, &h, &row_norm, &magnitude, &reciprocal_}) part->resize(m);
  }
  const int *const outer = p.J.outerIndexPtr(), *const counts = p.J.innerNonZeroPtr(),
                   *const column = p.J.innerIndexPtr();
  const double *const entry = p.J.valuePtr(), *const z_u_entry = p.z_u.data();
  std::size_t k = 0;
  Index part = 0;
  for (Index i = 0; i < m; ++i) {
    if (!std::isfinite(p.c[i])) continue;
    int e = outer[i];
    const int end = counts ? e + counts[i] : outer[i + 1];
    std::array<int, 2> met{-1, -1};
    double left = p.c[i];
    Lanes squares = Lanes::Zero();
    place[k] = part;
    for (int& b : met) {
      while (e < end && entry[e] == 0) ++e;
      if (e == end) break;
      b = column[e] / 6;
      const int first = 6 * b;
      const double* const inverse = L_inverse[at(b)].data();
      J.col(part).setZero();
      double* const own = J.col(part).data();
      Lanes g = Lanes::Zero();
      for (; e < end && column[e] < first + 6; ++e) {
        const double a = entry[e];
        const int in_body = column[e] - first;
        g += a * Eigen::Map<const Lanes>(inverse + lanes * in_body);
        left -= a * z_u_entry[column[e]];
        own[in_body] = a;
      }
      squares += g.cwiseAbs2();
      G.col(part++) = g;
    }
    while (e < end && entry[e] == 0) ++e;
    if (e < end) return false;
    c[static_cast<Index>(k)] = p.c[i];
    h[static_cast<Index>(k)] = left;
    row_norm[static_cast<Index>(k)] = squares.sum();
    row[k] = i;
    equality[k] = p.is_equality(i);
    body[k++] = met;
  }
  row.resize(k);
  equality.resize(k);
  body.resize(k);
  place.resize(k);
  return true;
}

// Roots and quotients of all rows side by side.
bool BodyRows::make_unit_rows() {
  auto norm = row_norm.head(rows()).array(), reciprocal = reciprocal_.head(rows()).array(),
       size = magnitude.head(rows()).array();
  norm = norm.sqrt();
  size = c.head(rows()).array().abs();
  Index odd = 0;
  for (Index k = 0; k < rows(); ++k) {
    const double x = row_norm[k], y = magnitude[k];
    const bool fits = (x > smallest) & (x < largest), none = y == 0;
    odd += !(fits & (none | ((y > smallest) & (y < largest))));
  }
  if (odd > 0) return false;
  reciprocal = 1 / norm;
  size *= reciprocal;
  h.head(rows()).array() *= reciprocal;
  for (Index k = 0; k < rows(); ++k) {
    part(k, 0) *= reciprocal[k];
    if (body[at(k)][1] >= 0) part(k, 1) *= reciprocal[k];
  }
  return true;
}

bool BodyRows::build(const Problem& p) {
  const Preparation preparing;
  const Index n = p.size();
  if (n == 0 || n % 6 != 0) return false;
  // What stays zero in a triangle is written once.
  const auto count = at(n / 6);
  if (M.size() != count)
    for (std::vector<Block>* part : {&M, &L_inverse, &L_inverse_t}) part->assign(count, Block::Zero());
  if (!factorize(p) || !load_rows(p) || !make_unit_rows()) return false;

  // The unit of length: the worst violation of z_u.
  double worst = 0;
  for (Index i = 0; i < rows(); ++i) reciprocal_[i] = equality[at(i)] ? std::abs(h[i]) : h[i];
  if (rows() > 0) worst = std::max(worst, reciprocal_.head(rows()).maxCoeff());
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
