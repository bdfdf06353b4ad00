#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include <zwang/core/referee/measure.h>
#include "tests/core/referee/hundred_digits.h"

namespace zwang {
namespace {

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

}  // namespace
}  // namespace zwang
