// What the solver for large stacks promises beyond the contract.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::z_error;

Solution solve(AnySolver& solver, const Problem& problem) {
  Solution s;
  solver.solve(problem, {}, s);
  return s;
}

TEST(Newton, AWallAndATowerOfThousandBoxesAtRestStayAtRest) {
  for (const char* scene : {"wall(boxes=1000,push=0)", "tower(boxes=1000)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver solver = make_solver("newton");
    const Solution s = solve(solver, problem);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_FALSE(s.fallback) << scene;
    EXPECT_LE(z_error(problem, s.z, Vector::Zero(problem.size())), 1e-15) << scene;
  }
}

TEST(Newton, PushedWallsAgreeWithTheDualActiveSet) {
  for (const char* scene : {"wall(boxes=60)", "wall(boxes=60,push=2,seed=3)", "stack(boxes=60,push=1)",
                            "pile(spheres=30)", "hands(hands=3,contacts=16)", "arch(stones=9)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver newton = make_solver("newton"), exact = DualActiveSet();
    const Solution s = solve(newton, problem), truth = solve(exact, problem);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    ASSERT_EQ(truth.status, Status::solved) << scene << ": " << truth.message;
    EXPECT_LE(z_error(problem, s.z, truth.z), 1e-12) << scene;
  }
}

// One factor serves the steps and the bound, so an accuracy is asked for without a price, and ends the polish earlier.
TEST(Newton, PromisesOfManyUnknownsAreKeptAndEndThePolish) {
  for (const char* scene :
       {"wall(boxes=60,push=2)", "stack(boxes=60,push=2)", "tower(boxes=60)", "pile(spheres=60,mass_ratio=1024)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver newton = make_solver("newton"), exact = DualActiveSet();
    const Vector truth = solve(exact, problem).z;
    int steps = std::numeric_limits<int>::max();
    for (const double accuracy : {1e-9, 1e-6, 1e-3, 0.1}) {
      const Solution s = newton.solve(problem, {.accuracy = accuracy});
      ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
      EXPECT_LE(s.error_bound, std::max(accuracy, 1e-5)) << scene;
      EXPECT_LE(z_error(problem, s.z, truth), s.error_bound) << scene << ", asked for " << accuracy;
      EXPECT_LE(s.iterations, steps) << scene;
      steps = s.iterations;
    }
  }
}

// By the factor at hand, also beside equality rows; where one of these repeats others there is no bound.
TEST(Newton, BoundsAnswersOfIndependentRowsNearby) {
  for (const char* scene : {"chain", "pile(spheres=6)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver newton = make_solver("newton"), exact = DualActiveSet();
    const Solution s = newton.solve(problem, {.accuracy = 1e-4}), plain = solve(newton, problem);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_LE(s.error_bound, 1e-12) << scene;
    EXPECT_LE(z_error(problem, s.z, solve(exact, problem).z), s.error_bound + 1e-15) << scene;
    EXPECT_EQ(s.iterations, plain.iterations) << scene;
  }
  const Problem repeats = make_scenes("random").front().problem;
  for (const char* name : {"newton", "pgs", "apgd", "cone"}) {
    const Solution s = make_solver(name).solve(repeats, {.accuracy = 1e-4});
    EXPECT_EQ(s.status, Status::solved) << name << ": " << s.message;
    EXPECT_TRUE(std::isnan(s.error_bound)) << name;
  }
}

// Equality rows that only an entry tells apart which is nothing beside the others: z = (1, 0).
TEST(Newton, NothingIsClaimedOfRowsThatAnEntryBelowRoundingTellsApart) {
  for (const double entry : {1e-16, 1e-19, 1e-20, 1e-30}) {
    const Problem p = test::make_problem(
        Vector::Ones(2), Eigen::Vector2d(3, 4),
        {{RowKind::equality, Eigen::Vector2d(1, 0), 1}, {RowKind::equality, Eigen::Vector2d(1, entry), 1}});
    for (const char* name : {"newton", "newton:polish=off"}) {
      const Solution s = make_solver(name).solve(p);
      EXPECT_TRUE(s.status != Status::solved || z_error(p, s.z, Eigen::Vector2d(1, 0)) <= 1e-8) << name << " " << entry;
    }
  }
}

// What is promised of a speed is returned relative to the motion, of which z_u is no measure here.
TEST(Newton, PromisesOfASpeedHoldFromRest) {
  Problem problem = make_scenes("stack(boxes=60)").front().problem;
  problem.z_u.setZero();
  problem.c.setConstant(1);
  AnySolver newton = make_solver("newton"), exact = DualActiveSet();
  const Solution s = newton.solve(problem, {.speed_accuracy = 1e-3});
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_FALSE(std::isinf(s.error_bound));
  const Vector truth = solve(exact, problem).z;
  for (Index b = 0; b < problem.size(); b += 6) EXPECT_LE((s.z - truth).segment<3>(b).norm(), 1e-3);
}

// Rows that let go one by one take the method alone a step each few of them.
TEST(Newton, AHeapTakesAsManyStepsAsAHandAndTheSameMotionWithoutTheInteriorPoint) {
  for (const char* scene : {"pile(spheres=300)", "pile(spheres=300,mass_ratio=1024)", "wall(boxes=200,push=4)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver newton = make_solver("newton"), alone = make_solver("newton:inside=off");
    const Solution s = solve(newton, problem), other = solve(alone, problem);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    ASSERT_EQ(other.status, Status::solved) << scene << ": " << other.message;
    EXPECT_LE(s.iterations, 25) << scene;
    EXPECT_LT(s.iterations, other.iterations) << scene;
    EXPECT_LE(z_error(problem, s.z, other.z), 1e-13) << scene;
    const Verdict verdict = measure(problem, s, nullptr, 1e-10).verdict;
    EXPECT_EQ(verdict, Verdict::solved) << scene;
  }
}

// Balls that touch: rows that repeat each other and agree but for the last digit. Too many for the dense method.
TEST(Newton, WhereTouchingBallsDoNotAgreeToTheLastDigitRowsLetGoAndTheAnswerSaysSo) {
  const Problem problem = make_scenes("pile(spheres=300,gap=0)").front().problem;
  ASSERT_GT(problem.size() * problem.rows(), 2000000);
  AnySolver solver = make_solver("newton");
  const Solution s = solve(solver, problem);
  EXPECT_EQ(s.status, Status::solved_ill_conditioned) << s.message;
  EXPECT_EQ(measure(problem, s, nullptr, 1e-10).verdict, Verdict::solved);
}

// Independent parts are searched apart: a hand takes the same point alone and among others.
TEST(Newton, HandsDoNotDisturbEachOther) {
  const Problem both = make_scenes("hands(hands=6,contacts=16)").front().problem;
  AnySolver solver = make_solver("newton");
  const Solution s = solve(solver, both);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  AnySolver exact = DualActiveSet();
  EXPECT_LE(z_error(both, s.z, solve(exact, both).z), 1e-13);
}

// Too large for the dense method: the proof must come from the sparse one. The first brick is asked to sink.
TEST(Newton, AWallThatCannotStandIsInfeasibleWithAProof) {
  Problem problem = make_scenes("wall(boxes=400)").front().problem;
  const Index m = problem.rows();
  ASSERT_GT(problem.size() * (m + 1), 2000000);
  Eigen::SparseMatrix<double, Eigen::RowMajor> J(m + 4, problem.size());
  J.topRows(m) = problem.J;
  problem.c.conservativeResize(m + 4);
  for (Index i = 0; i < 4; ++i) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(problem.J, i); it; ++it)
      J.insert(m + i, it.col()) = -it.value();
    problem.c[m + i] = 1 - problem.c[i];
    problem.kind.push_back(RowKind::inequality);
    problem.key.push_back({1u << 30, static_cast<std::uint32_t>(i)});
  }
  J.makeCompressed();
  problem.J = J;
  AnySolver solver = make_solver("newton");
  const Solution s = solve(solver, problem);
  ASSERT_EQ(s.status, Status::infeasible) << to_string(s.status) << ": " << s.message;
  EXPECT_FALSE(s.fallback);
  EXPECT_EQ(measure(problem, s, nullptr, 1e-10).verdict, Verdict::infeasible_proven);
}

TEST(Newton, SecondSolveOfAWallAndOfAPileAllocatesNothingAndGivesTheSameBits) {
  for (const char* scene : {"wall(boxes=200,push=1)", "pile(spheres=100)"}) {
    const Problem problem = make_scenes(scene).front().problem;
    AnySolver solver = make_solver("newton");
    Solution first, second;
    solver.solve(problem, {}, first);
    solver.solve(problem, {}, second);
    const long before = allocations();
    solver.solve(problem, {}, second);
    EXPECT_EQ(allocations() - before, 0) << scene;
    ASSERT_EQ(first.z.size(), second.z.size());
    const std::size_t bytes = sizeof(double) * at(first.z.size());
    EXPECT_EQ(std::memcmp(first.z.data(), second.z.data(), bytes), 0) << scene;
  }
}

// Opposed rows that hold as they are: earlier multipliers of both must not leave a trace of 1e-44 in z = 0.
TEST(Newton, WhereNothingIsViolatedZIsTheFreeMotionToTheLastBitFromAnyStart) {
  const Problem p = test::make_problem(test::vec({1, 1}), test::vec({0, 0}),
                                       {{RowKind::equality, test::vec({1, 0}), 0},
                                        {RowKind::equality, test::vec({2, 0}), 0},
                                        {RowKind::inequality, test::vec({-1, 1}), -1}});
  const WarmStart warm{.key = p.key, .lambda = test::vec({1, 2, 3})};
  AnySolver solver = make_solver("newton");
  const Solution s = solver.solve(p, {.warm_start = &warm});
  EXPECT_EQ(s.status, Status::solved);
  EXPECT_EQ(s.z, p.z_u);
}

TEST(Newton, AWarmStartSavesStepsAndGivesTheSameMotion) {
  const Problem problem = make_scenes("wall(boxes=100,push=2,seed=3)").front().problem;
  AnySolver solver = make_solver("newton");
  const Solution cold = solve(solver, problem);
  const WarmStart warm{.key = problem.key, .lambda = cold.lambda};
  Solution again;
  solver.solve(problem, {.warm_start = &warm}, again);
  ASSERT_EQ(again.status, Status::solved) << again.message;
  EXPECT_LT(again.iterations, cold.iterations);
  EXPECT_LE(z_error(problem, again.z, cold.z), 1e-14);
}

}  // namespace
}  // namespace zwang
