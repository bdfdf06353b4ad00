#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/orthogonal_rows.h>
#include <zwang/core/referee/sparse_proof.h>
#include "tests/core/hundred_digits.h"

namespace zwang {
namespace {

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
    const ScaledProblem gauge(p);
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

}  // namespace
}  // namespace zwang
