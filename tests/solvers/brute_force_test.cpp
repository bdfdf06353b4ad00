#include "tests/solvers/brute_force.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

// The yardstick itself: its answers meet the KKT conditions, and all three kinds of problem occur.
TEST(BruteForce, AnswersMeetTheKktConditions) {
  int infeasible = 0, constrained = 0;
  for (unsigned seed = 1000; seed < 1300; ++seed) {
    const Problem p = random_small_problem(seed);
    const auto truth = brute_force(p);
    if (!truth) {
      ++infeasible;
      continue;
    }
    constrained += truth->lambda.lpNorm<1>() > 0;
    const double tolerance = 1e-12 * (1 + truth->z.norm() + truth->lambda.lpNorm<1>());
    EXPECT_LE((p.M * (truth->z - p.z_u) - p.J.transpose() * truth->lambda).norm(), tolerance) << p.name;
    const Vector slack = p.J * truth->z - p.c;
    for (Index i = 0; i < p.rows(); ++i) {
      EXPECT_GE(slack[i], -tolerance) << p.name;
      EXPECT_LE(std::abs(p.is_equality(i) ? slack[i] : std::min(truth->lambda[i], slack[i])), tolerance) << p.name;
    }
  }
  EXPECT_GT(infeasible, 5);
  EXPECT_GT(constrained, 100);
}

}  // namespace
}  // namespace zwang
