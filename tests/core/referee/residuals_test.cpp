#include <gtest/gtest.h>

#include <algorithm>

#include <zwang/core/referee/measure.h>
#include "tests/core/referee/hundred_digits.h"

namespace zwang {
namespace {

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
