#include "solvers/pgs.h"

#include <gtest/gtest.h>

#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

Solution solve(const Problem& problem, const SolveOptions& options = {}, Pgs pgs = {}) {
  Solution solution;
  pgs.solve(problem, options, solution);
  return solution;
}

TEST(Pgs, PullsThroughAnEqualityRow) {
  const Problem p = test::tied_pair();
  const Solution s = solve(p);
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, test::vec({0, 0})), 1e-9);
  EXPECT_NEAR(s.lambda[0], -40, 1e-7);
  EXPECT_NEAR(s.lambda[1], 50, 1e-7);
}

TEST(Pgs, WaitsForTheSlowModesOfATallTower) {
  const Problem p = test::tower(30);
  const Solution s = solve(p, {.tolerance = 1e-8});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(30)), 1e-7);
  EXPECT_NEAR(s.lambda[0], 30 * 9.8125, 1e-3);
}

TEST(Pgs, SaysThatALargeMassRatioExhaustsItsSweeps) {
  const Solution s = solve(test::tower(10, 1048576));
  EXPECT_EQ(s.status, Status::iteration_limit);
  EXPECT_EQ(s.iterations, Pgs{}.max_sweeps);
}

TEST(Pgs, StopsAtTheSmallerOfItsTwoLimits) {
  EXPECT_EQ(solve(test::tower(30), {}, Pgs{.max_sweeps = 7}).iterations, 7);
  EXPECT_EQ(solve(test::tower(30), {.max_iterations = 3}).iterations, 3);
}

TEST(Pgs, StopsAtItsTimeLimit) { EXPECT_EQ(solve(test::tower(30), {.time_limit = 0}).status, Status::time_limit); }

TEST(Pgs, ProvesAConflictFromTheDriftOfItsMultipliers) {
  const Solution s = solve(test::squeezed());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_LE(test::farkas_residual(test::squeezed(), s.certificate), 1e-8);
}

TEST(Pgs, CertifiesAZeroRowThatCannotHold) {
  const Solution s = solve(test::zero_row_conflict());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_EQ(s.certificate, test::vec({1}));
}

TEST(Pgs, OverRelaxationNeedsFewerSweepsOnATower) {
  const Problem p = test::tower(20);
  const Solution plain = solve(p), relaxed = solve(p, {}, Pgs{.relaxation = 1.7});
  ASSERT_EQ(plain.status, Status::solved);
  ASSERT_EQ(relaxed.status, Status::solved);
  EXPECT_LT(relaxed.iterations, plain.iterations);
}

TEST(Pgs, StartsFromTheMultipliersOfTheFrameBefore) {
  const Problem p = test::tower(20);
  const Solution cold = solve(p);
  const WarmStart warm{.key = p.key, .lambda = cold.lambda};
  EXPECT_LT(solve(p, {.warm_start = &warm}).iterations, cold.iterations / 2);
}

}  // namespace
}  // namespace zwang
