#include <zwang/solvers/rivals/bullet.h>

#include <gtest/gtest.h>

#include <zwang/solvers/solver_entry.h>
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::solve;

TEST(BulletDantzig, PullsThroughAnEqualityRow) {
  const Problem p = test::tied_pair();
  const Solution s = solve<BulletDantzig>(p);
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, test::vec({0, 0})), 1e-12);
  EXPECT_NEAR(s.lambda[0], -40, 1e-9);
}

TEST(BulletDantzig, CarriesATowerOfAnyHeight) {
  for (Index count = 1; count <= 9; ++count) {
    const Problem p = test::tower(count);
    const Solution s = solve<BulletDantzig>(p);
    ASSERT_EQ(s.status, Status::solved) << count;
    EXPECT_LE(test::z_error(p, s.z, Vector::Zero(count)), 1e-12) << count;
  }
}

TEST(BulletDantzig, ConstraintForceMixingGivesWay) {
  const Problem p = test::tower(1);
  const Solution s = solve(p, {}, BulletDantzig{.cfm = 1});  // 2 lambda = h: half of the fall remains
  EXPECT_NEAR(s.z[0], p.z_u[0] / 2, 1e-12);
}

TEST(BulletDantzig, RefusesMoreRowsThanItsDenseMatrixAllows) {
  const Registered<BulletDantzig> solver;
  EXPECT_EQ(solver.supports(test::tower(10)), "");
  Problem large = test::tower(1);
  large.c = Vector::Zero(BulletDantzig::most_rows + 1);
  EXPECT_NE(solver.supports(large), "");
}

TEST(BulletDantzig, CertifiesAZeroRowThatCannotHold) {
  EXPECT_EQ(solve<BulletDantzig>(test::zero_row_conflict()).status, Status::infeasible);
}

TEST(BulletPgs, CarriesATowerToItsStepTolerance) {
  const Problem p = test::tower(10);
  const Solution s = solve<BulletPgs>(p, {.tolerance = 1e-12});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(10)), 1e-10);
}

TEST(BulletPgs, StopsAtTheSmallerOfItsTwoLimits) {
  const Problem p = test::tower(30);
  EXPECT_EQ(solve(p, {}, BulletPgs{.max_sweeps = 7}).iterations, 7);
  const Solution s = solve<BulletPgs>(p, {.max_iterations = 3});
  EXPECT_EQ(s.iterations, 3);
  EXPECT_EQ(s.status, Status::iteration_limit);
}

TEST(BulletPgs, StopsAtItsTimeLimit) {
  EXPECT_EQ(solve<BulletPgs>(test::tower(30), {.time_limit = 0}).status, Status::time_limit);
}

TEST(BulletPgs, StartsFromTheMultipliersOfTheFrameBefore) {
  const Problem p = test::tower(20);
  const Solution cold = solve<BulletPgs>(p);
  const WarmStart warm{.key = p.key, .lambda = cold.lambda};
  EXPECT_LT(solve<BulletPgs>(p, {.warm_start = &warm}).iterations, cold.iterations);
}

}  // namespace
}  // namespace zwang
