#include "solvers/apgd.h"

#include <gtest/gtest.h>

#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

Solution solve(const Problem& problem, const SolveOptions& options = {}, Apgd apgd = {}) {
  Solution solution;
  apgd.solve(problem, options, solution);
  return solution;
}

TEST(Apgd, PullsThroughAnEqualityRow) {
  const Problem p = test::tied_pair();
  const Solution s = solve(p);
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, test::vec({0, 0})), 1e-9);
  EXPECT_NEAR(s.lambda[0], -40, 1e-7);
  EXPECT_NEAR(s.lambda[1], 50, 1e-7);
}

TEST(Apgd, WaitsForTheSlowModesOfATallTower) {
  const Problem p = test::tower(30);
  const Solution s = solve(p, {.tolerance = 1e-8});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(30)), 1e-7);
  EXPECT_NEAR(s.lambda[0], 30 * 9.8125, 1e-3);
}

TEST(Apgd, SaysThatALargeMassRatioExhaustsItsSteps) {
  const Solution s = solve(test::tower(10, 1048576));
  EXPECT_EQ(s.status, Status::iteration_limit);
  EXPECT_EQ(s.iterations, Apgd{}.max_steps);
}

TEST(Apgd, StopsAtTheSmallerOfItsTwoLimits) {
  EXPECT_EQ(solve(test::tower(30), {}, Apgd{.max_steps = 7}).iterations, 7);
  EXPECT_EQ(solve(test::tower(30), {.max_iterations = 3}).iterations, 3);
}

TEST(Apgd, StopsAtItsTimeLimit) { EXPECT_EQ(solve(test::tower(30), {.time_limit = 0}).status, Status::time_limit); }

TEST(Apgd, ProvesAConflictFromTheDriftOfItsMultipliers) {
  const Solution s = solve(test::squeezed());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_LE(test::farkas_residual(test::squeezed(), s.certificate), 1e-8);
}

TEST(Apgd, CertifiesAZeroRowThatCannotHold) {
  const Solution s = solve(test::zero_row_conflict());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_EQ(s.certificate, test::vec({1}));
}

TEST(Apgd, RestartingNeedsFewerStepsOnATower) {
  const Problem p = test::tower(20);
  const Solution plain = solve(p, {}, Apgd{.restart = false}), restarted = solve(p);
  ASSERT_EQ(restarted.status, Status::solved);
  EXPECT_LT(restarted.iterations, plain.iterations);
}

TEST(Apgd, FindsTheCurvatureWithoutPowerIterations) {
  const Problem p = test::tower(20);
  const Solution s = solve(p, {}, Apgd{.power_iterations = 0});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(20)), 1e-9);
}

TEST(Apgd, StartsFromTheMultipliersOfTheFrameBefore) {
  const Problem p = test::tower(20);
  const Solution cold = solve(p);
  const WarmStart warm{.key = p.key, .lambda = cold.lambda};
  EXPECT_LT(solve(p, {.warm_start = &warm}).iterations, cold.iterations / 2);
}

}  // namespace
}  // namespace zwang
