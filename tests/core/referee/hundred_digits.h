#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <zwang/core/problem/problem.h>

// The yardstick of the referee's tests: small problems solved by enumeration in 100 digits.
namespace zwang {

using Big =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;
using BigMatrix = std::vector<std::vector<Big>>;
using BigVector = std::vector<Big>;

inline Big exactly(double x) { return Big(x); }

// Solves A x = b by elimination with full row pivoting in 100 digits; empty when A is singular to 1e-60.
inline std::optional<BigVector> solve(BigMatrix A, BigVector b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i)
      if (abs(A[i][k]) > abs(A[pivot][k])) pivot = i;
    if (abs(A[pivot][k]) < Big("1e-60")) return std::nullopt;
    std::swap(A[k], A[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Big factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= A[k][j] * b[j];
    b[k] /= A[k][k];
  }
  return b;
}

struct Answer {
  BigVector z, lambda;
};

// z* by trying every set of rows: the KKT system of the set in 100 digits, accepted when its multipliers are
// nonnegative and the other rows hold. Independent of everything in core/. Empty when no set passes: infeasible.
inline std::optional<Answer> brute_force(const Problem& p) {
  const auto n = static_cast<std::size_t>(p.size()), m = static_cast<std::size_t>(p.rows());
  const Matrix M = Matrix(p.M), J = Matrix(p.J);
  const Big zero("1e-50");
  for (unsigned set = 0; set < (1u << m); ++set) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < m; ++i)
      if (set >> i & 1) rows.push_back(i);
    if (rows.size() > n) continue;
    const std::size_t size = n + rows.size();
    BigMatrix A(size, BigVector(size, Big(0)));
    BigVector b(size, Big(0));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        A[i][j] = exactly(M(Index(i), Index(j)));
        b[i] += A[i][j] * exactly(p.z_u[Index(j)]);
      }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      b[n + k] = exactly(p.c[Index(rows[k])]);
      for (std::size_t j = 0; j < n; ++j) {
        A[n + k][j] = exactly(J(Index(rows[k]), Index(j)));
        A[j][n + k] = -A[n + k][j];
      }
    }
    const std::optional<BigVector> x = solve(A, b);
    if (!x) continue;
    bool good = true;
    for (std::size_t k = 0; k < rows.size(); ++k)
      good = good && (p.is_equality(Index(rows[k])) || (*x)[n + k] >= -zero);
    for (std::size_t i = 0; i < m && good; ++i) {
      Big slack = -exactly(p.c[Index(i)]);
      for (std::size_t j = 0; j < n; ++j) slack += exactly(J(Index(i), Index(j))) * (*x)[j];
      good = p.is_equality(Index(i)) ? abs(slack) <= zero : slack >= -zero;
    }
    if (!good) continue;
    Answer answer{BigVector(x->begin(), x->begin() + static_cast<std::ptrdiff_t>(n)), BigVector(m, Big(0))};
    for (std::size_t k = 0; k < rows.size(); ++k) answer.lambda[rows[k]] = (*x)[n + k];
    return answer;
  }
  return std::nullopt;
}

inline Big big_norm(const Matrix& M, const BigVector& d) {
  Big sum(0);
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t j = 0; j < d.size(); ++j) sum += exactly(M(Index(i), Index(j))) * d[i] * d[j];
  return sqrt(sum);
}

// |z - z*|_M / max(|z_u|_M, |z*|_M) in 100 digits.
inline double true_error(const Problem& p, const Vector& z, const BigVector& truth) {
  const Matrix M = Matrix(p.M);
  BigVector d, z_u;
  for (Index i = 0; i < p.size(); ++i) {
    d.push_back(exactly(z[i]) - truth[std::size_t(i)]);
    z_u.push_back(exactly(p.z_u[i]));
  }
  const Big s = std::max(std::max(big_norm(M, z_u), big_norm(M, truth)), Big(std::numeric_limits<double>::min()));
  return static_cast<double>(big_norm(M, d) / s);
}

inline Vector rounded(const BigVector& x) {
  Vector out(Index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) out[Index(i)] = static_cast<double>(x[i]);
  return out;
}

// A small problem with entries -1, 0, 1: degenerate, redundant, weakly active and inconsistent rows are all common.
// `kind` 1 makes one row nearly parallel to another, 2 uses ordinary random numbers, 3 couples M.
inline Problem random_problem(std::mt19937_64& random, int kind) {
  const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const Index n = pick(1, 4), m = pick(0, 6);
  Matrix M = Matrix::Identity(n, n), J(m, n);
  Vector z_u(n), c(m);
  for (Index i = 0; i < n; ++i) {
    M(i, i) = std::ldexp(1.0, pick(-3, 3));
    z_u[i] = pick(-2, 2);
  }
  if (kind == 3)
    for (Index i = 0; i + 1 < n; ++i) M(i, i + 1) = M(i + 1, i) = 0.25 * std::sqrt(M(i, i) * M(i + 1, i + 1));
  std::vector<RowKind> rows;
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) J(i, j) = kind == 2 ? std::normal_distribution<>()(random) : pick(-1, 1);
    c[i] = pick(-1, 1);
    rows.push_back(pick(0, 3) == 0 ? RowKind::equality : RowKind::inequality);
  }
  if (kind == 1 && m > 1) {
    const double eps = std::ldexp(1.0, -pick(3, 45));
    J.row(1) = J.row(0);
    J(1, pick(0, int(n) - 1)) += eps;
    if (pick(0, 1) == 1) c[1] = c[0];
  }
  Problem p{.name = "random", .M = M.sparseView(), .z_u = z_u, .J = J.sparseView(), .c = c, .kind = rows};
  p.key.resize(rows.size());
  return p;
}

}  // namespace zwang
