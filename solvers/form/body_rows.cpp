#include <zwang/solvers/form/body_rows.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <zwang/core/problem/preparation.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using lanes::Pack;

// Products of three such numbers neither overflow nor vanish. Of z_u and h the largest has to be one, no entry: what
// vanishes of smaller ones is nothing beside it, and speeds and gaps that fade reach 1e-318.
constexpr double smallest = 0x1p-300, largest = 0x1p300;
bool ordinary(double x) { return x > smallest && x < largest; }

}  // namespace

// Body b's block of M, and whether it is a mass and an inertia apart. False where an entry couples it to another body.
bool BodyRows::load_mass(const Problem& p, Index b, bool& apart) {
  constexpr std::array<int, 7> as_assembled{0, 1, 2, 3, 6, 9, 12};
  constexpr std::array<int, 12> place{0, 1, 2, 3, 4, 5, 3, 4, 5, 3, 4, 5},
      of_column{0, 1, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5};
  const int first = static_cast<int>(6 * b);
  const int *const outer = p.M.outerIndexPtr() + first, *const counts = p.M.innerNonZeroPtr(),
                   *const inner = p.M.innerIndexPtr() + outer[0];
  const double* const value = p.M.valuePtr() + outer[0];
  Block& own = mass[at(b)].M;
  own.setZero();
  int other = counts != nullptr;
  for (std::size_t j = 0; j < 7; ++j) other |= (outer[j] - outer[0]) ^ as_assembled[j];
  for (std::size_t e = 0; other == 0 && e < 12; ++e) other = inner[e] ^ (first + place[e]);
  if (other == 0) {
    for (std::size_t e = 0; e < 12; ++e) own(place[e], of_column[e]) = value[e];
    return true;
  }
  for (int j = 0; j < 6; ++j)
    for (SparseMatrix::InnerIterator it(p.M, first + j); it; ++it) {
      const Index i = it.row() - first;
      if (i >= 0 && i < 6)
        own(i, j) = it.value();
      else if (it.value() != 0)
        return false;
    }
  for (Index j = 0; j < 3; ++j)
    for (Index i = j + 1; i < 6; ++i) apart = apart && own(i, j) == 0;
  return true;
}

// M = L L', L^-1 and L'z_u of `size` unknowns of up to eight bodies, which no entry of M couples to the others. A root
// and a quotient wait for each other `size` times in eight bodies, not in each.
template <Index size>
bool BodyRows::factorize(Index base, Index first) {
  const Index count = std::min(lanes, bodies() - base);
  Pack L[size][size], X[size][size], z[size], reciprocal[size];
  for (Index i = 0; i < size; ++i) {
    z[i] = Pack(0);
    for (Index j = 0; j <= i; ++j) L[i][j] = Pack(i == j);
    for (Index lane = 0; lane < count; ++lane) {
      z[i].data()[lane] = z_u(first + i, base + lane);
      for (Index j = 0; j <= i; ++j) L[i][j].data()[lane] = mass[at(base + lane)].M(first + i, first + j);
    }
  }
  for (Index j = 0; j < size; ++j) {
    Pack d = L[j][j];
    for (Index k = 0; k < j; ++k) d -= L[j][k] * L[j][k];
    const Eigen::Map<const Eigen::Array<double, lanes, 1>> pivots(d.data());
    if (!(pivots > smallest && pivots < largest).all()) return false;
    L[j][j] = lanes::root(d);
    reciprocal[j] = 1 / L[j][j];
    for (Index i = j + 1; i < size; ++i) {
      for (Index k = 0; k < j; ++k) L[i][j] -= L[i][k] * L[j][k];
      L[i][j] *= reciprocal[j];
    }
  }
  for (Index j = 0; j < size; ++j) {
    z[j] *= L[j][j];
    for (Index i = j + 1; i < size; ++i) z[j] += L[i][j] * z[i];
    X[j][j] = reciprocal[j];
    for (Index i = j + 1; i < size; ++i) {
      X[i][j] = L[i][j] * X[j][j];
      for (Index k = j + 1; k < i; ++k) X[i][j] += L[i][k] * X[k][j];
      X[i][j] *= -reciprocal[i];
    }
  }
  for (Index lane = 0; lane < count; ++lane) {
    double* const inverse = &mass[at(base + lane)].L_inverse(first, first);
    double* const transposed = &mass[at(base + lane)].L_inverse_t(first, first);
    for (Index j = 0; j < size; ++j) {
      free(first + j, base + lane) = z[j].data()[lane];
      for (Index i = j; i < size; ++i) inverse[lanes * j + i] = transposed[lanes * i + j] = X[i][j].data()[lane];
    }
  }
  return true;
}

double BodyRows::tied() const {
  double most = 1;
  for (const Mass& m : mass)
    for (Index j = 0; j < 6; ++j) most = std::max(most, m.M(j, j) * m.L_inverse.col(j).squaredNorm());
  return most;
}

bool BodyRows::factorize(const Problem& p) {
  free.setZero(lanes, bodies());
  z_u.setZero(lanes, bodies());
  z_u.topRows<6>() = p.z_u.reshaped(6, bodies());
  for (Index i = 0; i < p.size(); ++i)
    if (!(std::abs(p.z_u[i]) < largest)) return false;
  for (Index base = 0; base < bodies(); base += lanes) {
    bool apart = true;
    for (Index b = base; b < std::min(base + lanes, bodies()); ++b) {
      if (!load_mass(p, b, apart)) return false;
      mass[at(b)].L_inverse.setZero();
      mass[at(b)].L_inverse_t.setZero();
    }
    if (apart ? !(factorize<1>(base, 0) && factorize<1>(base, 1) && factorize<1>(base, 2) && factorize<3>(base, 3))
              : !factorize<6>(base, 0))
      return false;
  }
  return true;
}

// J by bodies, of which assembly stores all six entries and others may store fewer. False where a row meets more than
// two bodies.
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
  const double *const entry = p.J.valuePtr(), *const own_c = p.c.data();
  double* part = J.data();
  std::size_t k = 0;
  for (Index i = 0; i < m; ++i) {
    if (!std::isfinite(own_c[i])) continue;
    const int end = counts ? outer[i] + counts[i] : outer[i + 1];
    std::array<int, 2> met{-1, -1};
    std::size_t bodies = 0;
    place[k] = (part - J.data()) / lanes;
    for (int e = outer[i]; e < end;) {
      const int b = column[e] / 6, first = 6 * b;
      std::array<std::uint64_t, 6> bits{};
      if (column[e] == first && e + 5 < end && column[e + 5] == first + 5) {
        std::memcpy(bits.data(), entry + e, sizeof bits);
        e += 6;
      } else {
        for (; e < end && column[e] < first + 6; ++e)
          bits[at(column[e] - first)] = std::bit_cast<std::uint64_t>(entry[e]);
      }
      if ((bits[0] | bits[1] | bits[2] | bits[3] | bits[4] | bits[5]) << 1 == 0) continue;  // zeros of either sign
      if (bodies == met.size()) return false;
      met[bodies++] = b;
      std::memcpy(part, bits.data(), sizeof bits);
      part[6] = part[7] = 0;
      part += lanes;
    }
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

// G = J L^-T, h = c - J z_u and squares of norms, of rows as they stand.
void BodyRows::whiten_rows(const Problem& p) {
  const double *own = J.data(), *const z_u_entry = p.z_u.data();
  double* whitened = G.data();
  for (std::size_t k = 0; k < row.size(); ++k) {
    double left = p.c[row[k]];
    Lanes squares = Lanes::Zero();
    c[static_cast<Index>(k)] = left;
    for (const int b : body[k]) {
      if (b < 0) break;
      const Block& inverse = mass[at(b)].L_inverse;
      Lanes g = Lanes::Zero();
      for (Index j = 0; j < 6; ++j) {
        g = multiply_add(own[j], inverse.col(j), g);
        left = multiply_add(-own[j], z_u_entry[6 * b + j], left);
      }
      squares = multiply_add(g, g, squares);
      Eigen::Map<Lanes>{whitened} = g;
      own += lanes;
      whitened += lanes;
    }
    h[static_cast<Index>(k)] = left;
    row_norm[static_cast<Index>(k)] = squares.sum();
  }
}

// Roots and quotients of all rows side by side. (Eigen's roots of eight doubles are a digit short, those that are left
// over are not: bits would depend on which rows there are.)
bool BodyRows::make_unit_rows() {
  auto norm = row_norm.head(rows()).array(), reciprocal = reciprocal_.head(rows()).array(),
       size = magnitude.head(rows()).array();
  for (double& own : row_norm.head(rows())) own = std::sqrt(own);
  size = c.head(rows()).array().abs();
  Index odd = 0;
  for (Index k = 0; k < rows(); ++k) {
    const double x = row_norm[k];
    odd += !((x > smallest) & (x < largest) & (magnitude[k] < largest));
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
  mass.resize(at(n / 6));
  if (!factorize(p) || !load_rows(p)) return false;
  whiten_rows(p);
  if (!make_unit_rows()) return false;

  // The unit of length: the worst violation of z_u, unless it has faded beside z_u.
  double worst = 0;
  for (Index i = 0; i < rows(); ++i) reciprocal_[i] = equality[at(i)] ? std::abs(h[i]) : h[i];
  if (rows() > 0) worst = std::max(worst, reciprocal_.head(rows()).maxCoeff());
  free_norm = free.norm();
  const double size = ordinary(worst) ? worst : free_norm;
  if (!(std::max(worst, free_norm) < largest) || !(ordinary(size) || (worst == 0 && p.z_u.isZero(0)))) return false;
  exponent = 0;
  (void)std::frexp(size, &exponent);
  const double unit = std::ldexp(1.0, -exponent);
  h.head(rows()) *= unit;
  free *= unit;
  free_norm *= unit;
  magnitude.head(rows()) *= unit;
  magnitude.head(rows()).array() += free_norm;
  return true;
}

}  // namespace zwang
