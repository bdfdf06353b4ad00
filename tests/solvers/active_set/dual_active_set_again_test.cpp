// Solving again: warm starts, second solves that allocate nothing, and what an observer or a limit changes.
#include <gtest/gtest.h>

#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::make_problem;
using test::solve;
using test::vec;

TEST(DualActiveSet, IterationLimitGivesTheLastIterate) {
  const Solution s = solve<DualActiveSet>(test::tower(10), {.max_iterations = 3});
  EXPECT_EQ(s.status, Status::iteration_limit);
  EXPECT_EQ(s.iterations, 3);
  EXPECT_TRUE(s.z.allFinite());
}

TEST(DualActiveSet, WarmStartTakesNoStepWhenNothingChanged) {
  const Problem p = test::tower(20);
  const Solution cold = solve<DualActiveSet>(p);
  EXPECT_GT(cold.iterations, 10);
  const WarmStart warm{.key = p.key, .lambda = cold.lambda};
  const Solution again = solve<DualActiveSet>(p, {.warm_start = &warm});
  EXPECT_EQ(again.iterations, 0);
  EXPECT_LE(test::z_error(p, again.z, cold.z), 1e-28);  // the active rows stand in another order
}

TEST(DualActiveSet, WarmStartFollowsKeysNotPositions) {
  const Problem p = test::tower(6);
  const Solution cold = solve<DualActiveSet>(p);
  WarmStart warm{.key = {p.key.rbegin(), p.key.rend()}, .lambda = cold.lambda.reverse()};
  warm.key[2] = {.constraint = 77, .row = 0};
  const Solution again = solve<DualActiveSet>(p, {.warm_start = &warm});
  EXPECT_EQ(again.iterations, 1);
  EXPECT_LE(test::z_error(p, again.z, cold.z), 1e-15);
}

TEST(DualActiveSet, ObserverSeesEveryEnteringRowAndChangesNothing) {
  const Problem p = test::tower(12);
  Solution plain;
  DualActiveSet careful;
  careful.reduce = false;
  careful.solve(p, {}, plain);
  int seen = 0;
  Vector last;
  SolveOptions options;
  options.observe = [&](int, const Vector& z, const Vector& lambda) {
    ++seen;
    last = z;
    EXPECT_EQ(lambda.size(), 12);
  };
  const Solution observed = solve<DualActiveSet>(p, options);
  EXPECT_EQ(observed.z, plain.z);
  EXPECT_EQ(observed.iterations, plain.iterations);
  EXPECT_GE(seen, 12);
  EXPECT_EQ(last, plain.z);
  EXPECT_LE(test::z_error(p, solve<DualActiveSet>(p).z, plain.z), 1e-28);  // the path that is not observed
}

TEST(DualActiveSet, SecondSolveAllocatesNothingWarmOrCold) {
  const Problem p = test::tower(40);
  DualActiveSet solver;
  Solution s;
  solver.solve(p, {}, s);
  const WarmStart warm{.key = p.key, .lambda = s.lambda};
  solver.solve(p, {.warm_start = &warm}, s);
  const long before = allocations();
  solver.solve(p, {}, s);
  solver.solve(p, {.warm_start = &warm}, s);
  EXPECT_EQ(allocations() - before, 0);
}

TEST(DualActiveSet, SecondSolveAllocatesNothingWhereDroppedRowsAreJudgedAgain) {
  const Problem p =
      make_problem(vec({1, 1}), vec({-1, -1}),
                   {{RowKind::inequality, vec({0, 1}), 0}, {RowKind::inequality, vec({0x1p-48, -1}), 0x1p-48}});
  DualActiveSet solver;
  Solution s;
  solver.solve(p, {}, s);
  EXPECT_TRUE(s.fallback);
  const long before = allocations();
  solver.solve(p, {}, s);
  EXPECT_EQ(allocations() - before, 0);
}

}  // namespace
}  // namespace zwang
