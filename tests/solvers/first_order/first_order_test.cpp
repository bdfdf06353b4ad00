// What the two first-order methods, projected Gauss-Seidel and accelerated projected gradient, have in common.
#include <gtest/gtest.h>

#include <zwang/solvers/first_order/apgd.h>
#include <zwang/solvers/first_order/pgs.h>
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::solve;

int& limit(Pgs& solver) { return solver.max_sweeps; }
int& limit(Apgd& solver) { return solver.max_steps; }

template <class Solver>
class FirstOrder : public testing::Test {};

struct Named {
  template <class Solver>
  static std::string GetName(int) {
    return Solver::name;
  }
};
using Solvers = testing::Types<Pgs, Apgd>;
TYPED_TEST_SUITE(FirstOrder, Solvers, Named);

TYPED_TEST(FirstOrder, PullsThroughAnEqualityRow) {
  const Problem p = test::tied_pair();
  const Solution s = solve<TypeParam>(p);
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, test::vec({0, 0})), 1e-9);
  EXPECT_NEAR(s.lambda[0], -40, 1e-7);
  EXPECT_NEAR(s.lambda[1], 50, 1e-7);
}

TYPED_TEST(FirstOrder, WaitsForTheSlowModesOfATallTower) {
  const Problem p = test::tower(30);
  const Solution s = solve<TypeParam>(p, {.tolerance = 1e-8});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(30)), 1e-7);
  EXPECT_NEAR(s.lambda[0], 30 * 9.8125, 1e-3);
}

TYPED_TEST(FirstOrder, SaysThatALargeMassRatioExhaustsItsIterations) {
  const Solution s = solve<TypeParam>(test::tower(10, 1048576));
  EXPECT_EQ(s.status, Status::iteration_limit);
  TypeParam solver;
  EXPECT_EQ(s.iterations, limit(solver));
}

TYPED_TEST(FirstOrder, StopsAtTheSmallerOfItsTwoLimits) {
  TypeParam solver;
  limit(solver) = 7;
  EXPECT_EQ(solve(test::tower(30), {}, solver).iterations, 7);
  EXPECT_EQ(solve<TypeParam>(test::tower(30), {.max_iterations = 3}).iterations, 3);
}

TYPED_TEST(FirstOrder, StopsAtItsTimeLimit) {
  EXPECT_EQ(solve<TypeParam>(test::tower(30), {.time_limit = 0}).status, Status::time_limit);
}

TYPED_TEST(FirstOrder, ProvesAConflictFromTheDriftOfItsMultipliers) {
  const Solution s = solve<TypeParam>(test::squeezed());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_LE(test::farkas_residual(test::squeezed(), s.certificate), 1e-8);
}

TYPED_TEST(FirstOrder, CertifiesAZeroRowThatCannotHold) {
  const Solution s = solve<TypeParam>(test::zero_row_conflict());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_EQ(s.certificate, test::vec({1}));
}

TYPED_TEST(FirstOrder, StartsFromTheMultipliersOfTheFrameBefore) {
  const Problem p = test::tower(20);
  const Solution cold = solve<TypeParam>(p);
  const WarmStart warm{.key = p.key, .lambda = cold.lambda};
  EXPECT_LT(solve<TypeParam>(p, {.warm_start = &warm}).iterations, cold.iterations / 2);
}

TEST(Pgs, OverRelaxationNeedsFewerSweepsOnATower) {
  const Problem p = test::tower(20);
  const Solution plain = solve<Pgs>(p), relaxed = solve(p, {}, Pgs{.relaxation = 1.7});
  ASSERT_EQ(plain.status, Status::solved);
  ASSERT_EQ(relaxed.status, Status::solved);
  EXPECT_LT(relaxed.iterations, plain.iterations);
}

TEST(Apgd, RestartingNeedsFewerStepsOnATower) {
  const Problem p = test::tower(20);
  const Solution plain = solve(p, {}, Apgd{.restart = false}), restarted = solve<Apgd>(p);
  ASSERT_EQ(restarted.status, Status::solved);
  EXPECT_LT(restarted.iterations, plain.iterations);
}

TEST(Apgd, FindsTheCurvatureWithoutPowerIterations) {
  const Problem p = test::tower(20);
  const Solution s = solve(p, {}, Apgd{.power_iterations = 0});
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(20)), 1e-9);
}

}  // namespace
}  // namespace zwang
