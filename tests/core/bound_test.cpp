#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <optional>
#include <random>

#include "core/measure.h"
#include "core/orthogonal_rows.h"
#include "core/sparse_proof.h"

namespace zwang {
namespace {

using Big =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;
using BigMatrix = std::vector<std::vector<Big>>;
using BigVector = std::vector<Big>;

Big exactly(double x) { return Big(x); }

// Solves A x = b by elimination with full row pivoting in 100 digits; empty when A is singular to 1e-60.
std::optional<BigVector> solve(BigMatrix A, BigVector b) {
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
std::optional<Answer> brute_force(const Problem& p) {
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

Big big_norm(const Matrix& M, const BigVector& d) {
  Big sum(0);
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t j = 0; j < d.size(); ++j) sum += exactly(M(Index(i), Index(j))) * d[i] * d[j];
  return sqrt(sum);
}

// |z - z*|_M / max(|z_u|_M, |z*|_M) in 100 digits.
double true_error(const Problem& p, const Vector& z, const BigVector& truth) {
  const Matrix M = Matrix(p.M);
  BigVector d, z_u;
  for (Index i = 0; i < p.size(); ++i) {
    d.push_back(exactly(z[i]) - truth[std::size_t(i)]);
    z_u.push_back(exactly(p.z_u[i]));
  }
  const Big s = std::max(std::max(big_norm(M, z_u), big_norm(M, truth)), Big(std::numeric_limits<double>::min()));
  return static_cast<double>(big_norm(M, d) / s);
}

Vector rounded(const BigVector& x) {
  Vector out(Index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) out[Index(i)] = static_cast<double>(x[i]);
  return out;
}

// A small problem with entries -1, 0, 1: degenerate, redundant, weakly active and inconsistent rows are all common.
// `kind` 1 makes one row nearly parallel to another, 2 uses ordinary random numbers, 3 couples M.
Problem random_problem(std::mt19937_64& random, int kind) {
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

// 6000 problems x 6 answers of growing error, with and without multipliers, the reference withheld.
TEST(Bound, HoldsAgainstEnumerationIn100Digits) {
  std::mt19937_64 random(1);
  int right = 0, right_decided = 0, feasible = 0, infeasible = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const Problem p = random_problem(random, trial % 4);
    const std::optional<Answer> truth = brute_force(p);
    (truth ? feasible : infeasible)++;
    for (const double error : {0.0, 1e-15, 1e-12, 1e-9, 1e-5, 1.0}) {
      Solution s{.status = Status::solved, .z = truth ? rounded(truth->z) : p.z_u};
      if (truth && trial % 2 == 0) s.lambda = rounded(truth->lambda);
      for (double& x : s.z) x += error * std::normal_distribution<>()(random);
      const Metrics found = measure(p, s, nullptr, 1e-14);
      ASSERT_TRUE(truth || found.verdict != Verdict::solved) << "trial " << trial << ": infeasible problem";
      if (!truth) continue;
      const double actual = true_error(p, s.z, truth->z);
      ASSERT_LE(actual, found.z_bound * (1 + 1e-9) + 1e-40) << "trial " << trial << " error " << error;
      ASSERT_TRUE(found.verdict != Verdict::wrong || actual > 1e-9) << "trial " << trial << " error " << error;
      right += actual <= 1e-12;
      right_decided += actual <= 1e-12 && found.verdict == Verdict::solved;
    }
  }
  EXPECT_GT(feasible, 3000);
  EXPECT_GT(infeasible, 1000);
  EXPECT_GE(right_decided, 0.99 * right) << right_decided << " of " << right;
  std::cout << "feasible " << feasible << ", infeasible " << infeasible
            << "; right answers put at solved: " << right_decided << " of " << right << '\n';
}

// The bound of large stacks, on small problems of inequality rows.
TEST(SparseProof, HoldsAgainstEnumerationIn100Digits) {
  std::mt19937_64 random(2);
  int proven = 0, useful = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    Problem p = random_problem(random, trial % 4);
    std::ranges::fill(p.kind, RowKind::inequality);
    const std::optional<Answer> truth = brute_force(p);
    const Gauge gauge(p);
    for (const double error : {0.0, 1e-15, 1e-9, 1e-3}) {
      Vector z = truth ? rounded(truth->z) : p.z_u, lambda = Vector::Zero(p.rows());
      if (truth) lambda = rounded(truth->lambda);
      for (double& x : z) x += error * std::normal_distribution<>()(random);
      for (double& x : lambda) x *= 1 + error * std::normal_distribution<>()(random);
      const Proof proof = prove_sparse(gauge, gauge.motion(z), gauge.multipliers(lambda));
      if (proof.radius == std::numeric_limits<double>::infinity()) continue;
      ASSERT_TRUE(truth) << "trial " << trial << ": infeasible problem";
      BigVector off;
      for (std::size_t i = 0; i < proof.d.size(); ++i) {
        const Big d = exactly(proof.d[i].hi) + exactly(proof.d[i].lo),
                  unit = exactly(std::ldexp(1.0, gauge.motion_exponent));
        off.push_back(exactly(p.z_u[Index(i)]) + d * unit - truth->z[i]);
      }
      const Big distance = big_norm(Matrix(p.M), off);
      ASSERT_LE(distance, exactly(gauge.to_problem_norm(proof.radius)) + Big("1e-60"))
          << "trial " << trial << " error " << error;
      ++proven;
      useful += gauge.to_problem_norm(proof.radius) <= 1e-12;
    }
  }
  EXPECT_GT(proven, 4000);
  EXPECT_GE(useful, 0.7 * proven) << useful << " of " << proven;
  std::cout << "bounded: " << proven << ", to 1e-12: " << useful << '\n';
}

// Unit masses on top of each other, more than the dense proof takes: z = 0, mass k carries what is above it.
TEST(Bound, DecidesOnLargeStacks) {
  constexpr Index n = 2000;
  Problem p{.name = "stack", .M = Matrix::Identity(n, n).sparseView(), .z_u = Vector::Constant(n, -9.8125)};
  p.J.resize(n, n);
  for (Index i = 0; i < n; ++i) {
    p.J.insert(i, i) = 1;
    if (i > 0) p.J.insert(i, i - 1) = -1;
  }
  p.c = Vector::Zero(n);
  p.kind.assign(n, RowKind::inequality);
  p.key.resize(n);
  Solution s{.status = Status::solved, .z = Vector::Zero(n), .lambda = Vector::LinSpaced(n, n, 1) * 9.8125};
  EXPECT_EQ(measure(p, s, nullptr, 1e-10).verdict, Verdict::solved);
  s.lambda[7] *= 1 + 1e-9;  // only a guess
  EXPECT_EQ(measure(p, s, nullptr, 1e-10).verdict, Verdict::solved);
  s.z[3] += 1e-5;
  const Metrics off = measure(p, s, nullptr, 1e-10);
  EXPECT_NE(off.verdict, Verdict::solved);
  EXPECT_GE(off.z_bound, 1e-5 / (9.8125 * std::sqrt(n)));
  s.z[3] = 0;
  p.c[n - 1] = 1;  // another problem
  EXPECT_NE(measure(p, s, nullptr, 1e-10).verdict, Verdict::solved);
}

TEST(Residuals, MatchArithmeticIn100Digits) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 500; ++trial) {
    Problem p = random_problem(random, 2 + trial % 2);
    const auto n = std::size_t(p.size()), m = std::size_t(p.rows());
    const Matrix M = Matrix(p.M), J = Matrix(p.J);
    Vector z(p.size()), lambda(p.rows());
    for (double& x : z) x = std::normal_distribution<>()(random);
    for (double& x : lambda) x = std::normal_distribution<>()(random);
    const Reference truth{.z = p.z_u * 0.5};
    const Metrics found = measure(p, {.status = Status::solved, .z = z, .lambda = lambda}, &truth, 1e-10);

    // Everything again, the slow way, with M^-1 by elimination.
    BigMatrix big_M(n, BigVector(n));
    BigVector d(n), force(n, Big(0)), z_u(n), half(n);
    for (std::size_t i = 0; i < n; ++i) {
      d[i] = exactly(z[Index(i)]) - exactly(p.z_u[Index(i)]);
      z_u[i] = exactly(p.z_u[Index(i)]);
      half[i] = z_u[i] / 2;
      for (std::size_t j = 0; j < n; ++j) big_M[i][j] = exactly(M(Index(i), Index(j)));
    }
    const Big s = std::max(std::max(big_norm(M, z_u), big_norm(M, half)), Big(std::numeric_limits<double>::min()));
    Big primal(0), dual(0), complementarity(0), natural(0), weighted(0);
    bool impossible = false;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) force[i] += big_M[i][j] * d[j];
    for (std::size_t i = 0; i < m; ++i) {
      BigVector row(n);
      Big slack = -exactly(p.c[Index(i)]);
      for (std::size_t j = 0; j < n; ++j) {
        row[j] = exactly(J(Index(i), Index(j)));
        slack += row[j] * exactly(z[Index(j)]);
        force[j] -= row[j] * exactly(lambda[Index(i)]);
      }
      const BigVector x = *solve(big_M, row);
      Big squared(0);
      for (std::size_t j = 0; j < n; ++j) squared += row[j] * x[j];
      if (squared == 0) {  // a row of zeros that cannot hold is violated without measure
        const double c = p.c[Index(i)];
        impossible = impossible || (p.is_equality(Index(i)) ? c != 0 : c > 0);
        continue;
      }
      const Big norm = sqrt(squared), weight = exactly(lambda[Index(i)]) * norm, unit = slack / norm;
      weighted += exactly(lambda[Index(i)]) * slack;
      if (p.is_equality(Index(i))) {
        primal = std::max(primal, Big(abs(unit)));
        natural = std::max(natural, Big(abs(unit)));
        continue;
      }
      primal = std::max(primal, Big(-unit));
      dual = std::max(dual, Big(-weight));
      complementarity = std::max(complementarity, Big(abs(weight * unit)));
      natural = std::max(natural, Big(abs(std::min(weight, unit))));
    }
    const BigVector x = *solve(big_M, force);
    Big stationarity(0);
    for (std::size_t j = 0; j < n; ++j) stationarity += force[j] * x[j];
    const auto expect = [&](double value, const Big& exact, const char* what) {
      EXPECT_NEAR(value, static_cast<double>(exact), 1e-14 * (1 + std::abs(static_cast<double>(exact))))
          << what << ", trial " << trial;
    };
    if (s < Big(1e-100)) continue;  // everything at rest: z is measured against the smallest normal number
    if (impossible)
      EXPECT_EQ(found.primal, std::numeric_limits<double>::infinity()) << "trial " << trial;
    else
      expect(found.primal, primal / s, "primal");
    expect(found.dual, dual / s, "dual");
    expect(found.complementarity, complementarity / s / s, "complementarity");
    expect(found.natural, natural / s, "natural");
    expect(found.stationarity, sqrt(stationarity) / s, "stationarity");
    expect(found.gap, (stationarity / 2 + weighted) / s / s, "gap");
  }
}

// z_error means something below the rounding of z itself.
TEST(Residuals, ErrorsOf1eMinus17AreSeen) {
  Problem p{.z_u = Vec3(1, 0, 0), .c = Vector(0)};
  p.M.resize(3, 3);
  p.M.setIdentity();
  p.J.resize(0, 3);
  const Reference truth{.z = Vec3(1, 0, 0)};
  const Solution s{.status = Status::solved, .z = Vec3(1, 3e-17, 4e-17)};
  EXPECT_NEAR(measure(p, s, &truth, 1e-10).z_error, 5e-17, 1e-30);
}

}  // namespace
}  // namespace zwang
