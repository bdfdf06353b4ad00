#include <zwang/bench/fuzz/small_problem.h>

#include <gtest/gtest.h>

#include <zwang/bench/fuzz/frictional_problem.h>
#include <zwang/bench/references/friction/coulomb.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/core/problem/law.h>
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

// The truth of a fuzzing run, and a method that shares neither code nor arithmetic with it.
TEST(SmallProblems, AreDecidedByHundredDigitsAsByRationals) {
  int infeasible = 0, redundant = 0;
  for (std::uint64_t number = 0; number < 2000; ++number) {
    const Problem p = small_problem(7, number);
    const auto digits = multiprecision_reference(p), rational = rational_reference(p);
    ASSERT_TRUE(digits && rational) << p.name;
    ASSERT_EQ(digits->feasible, rational->feasible) << p.name;
    if (!digits->feasible) {
      ++infeasible;
      Problem finite = p;  // 0 times -Inf is no number
      for (Index i = 0; i < p.rows(); ++i)
        if (digits->certificate[i] == 0) finite.c[i] = 0;
      EXPECT_LE(test::farkas_residual(finite, digits->certificate), 1e-15) << p.name;
      continue;
    }
    EXPECT_LE(relative_distance(p, digits->z, rational->z), 1e-15) << p.name;
    const Vector force = p.M * (digits->z - p.z_u) - p.J.transpose() * digits->lambda;
    EXPECT_LE(force.norm(), 1e-13 * (1 + digits->lambda.norm())) << p.name;
    for (Index i = 0; i < p.rows(); ++i) {
      if (!p.is_equality(i)) {
        EXPECT_GE(digits->lambda[i], 0) << p.name;
      }
      redundant += p.is_equality(i) && digits->lambda[i] == 0;
    }
  }
  EXPECT_GT(infeasible, 400);
  EXPECT_LT(infeasible, 1600);
  EXPECT_GT(redundant, 100);
}

// x + y = 0 and 2 x + 2 y = 0 agree at y = -1, x = 1 but for the last of 100 digits: that is no contradiction, and
// x <= -1 is one.
TEST(SmallProblems, AreDecidedWhereEqualRowsMeetAMotionToRounding) {
  const auto digits = multiprecision_reference(small_problem(77, 53692));
  ASSERT_TRUE(digits);
  EXPECT_FALSE(digits->feasible);
}

// The truth that the referee is asked against, and two other methods.
TEST(ExactSolutions, AgreeWithHundredDigitsAndWithIntervalNewton) {
  for (std::uint64_t number = 0; number < 400; ++number) {
    const Problem p = small_problem(8, number, 4, 8);
    const ExactSolutions all(p);
    const auto digits = multiprecision_reference(p);
    ASSERT_EQ(all.solutions().size(), digits->feasible ? 1u : 0u) << p.name;
    if (digits->feasible) {
      EXPECT_LE(all.error(digits->z).high, 2e-16) << p.name;
    }
  }
  int several = 0, none = 0, convex = 0, proven = 0;
  for (std::uint64_t number = 0; number < 400; ++number) {
    const Problem p = frictional_problem(8, 10 * number);
    const ExactSolutions all(p);
    const Problem pyramid = under(Law::pyramid, p);
    Problem own = p;
    own.law = Law::convex;
    if (const auto digits = multiprecision_reference(pyramid)) {
      const ExactSolutions one(own);
      ASSERT_EQ(one.solutions().size(), digits->feasible ? 1u : 0u) << p.name;
      convex += digits->feasible;
      if (digits->feasible) {
        EXPECT_LE(one.error(digits->z).high, 2e-16) << p.name;
      }
    }
    if (!all.complete()) continue;
    several += all.solutions().size() > 1;
    none += all.solutions().empty();
    for (const CoulombSolution& s : coulomb_solutions(p)) {
      if (s.delta > 0) continue;
      ++proven;
      EXPECT_LE(all.error(s.z).high, s.bound + 2e-16) << p.name;
    }
  }
  EXPECT_GT(convex, 20);
  EXPECT_GT(several, 2);
  EXPECT_GT(none, 20);
  EXPECT_GT(proven, 50);
}

// x = 3 beside z_u = 4 with M = 4: off by 2 of 8.
TEST(ExactSolutions, MeasuresInTheMassNorm) {
  const Problem p = test::make_problem(test::vec({4}), test::vec({4}), {{RowKind::inequality, test::vec({-1}), -3}});
  const ExactSolutions one(p);
  EXPECT_EQ(one.solutions().front().z, test::vec({3}));
  EXPECT_EQ(one.solutions().front().lambda, test::vec({4}));
  EXPECT_EQ(one.misses().front().z, test::vec({4}));
  EXPECT_EQ(one.error(test::vec({4})).low, .25);
  EXPECT_EQ(one.motions(), .25);
}

TEST(SmallProblems, HoldWhatBreaksMethods) {
  int no_rows = 0, six = 0, zero_rows = 0, repeated = 0, silent = 0, coupled = 0;
  for (std::uint64_t number = 0; number < 2000; ++number) {
    const Problem p = small_problem(1, number);
    EXPECT_EQ(bad_input(p), "") << p.name;
    EXPECT_TRUE(is_positive_definite(p.M)) << p.name;
    const Matrix J = p.J;
    no_rows += p.rows() == 0;
    six += p.size() == 6;
    coupled += !Matrix(p.M).isDiagonal();
    for (Index i = 0; i < p.rows(); ++i) {
      zero_rows += J.row(i).isZero(0);
      silent += std::isinf(p.c[i]);
      for (Index k = 0; k < i; ++k) repeated += p.is_equality(i) && p.is_equality(k) && J.row(i) == J.row(k);
    }
  }
  for (const int count : {no_rows, six, zero_rows, repeated, silent, coupled}) EXPECT_GT(count, 50);
}

TEST(SmallProblems, SpoiltEntriesAreNamed) {
  int bad = 0;
  for (std::uint64_t number = 0; number < 1000; ++number) {
    const Spoilt spoilt = spoil(small_problem(1, number), number);
    bad += spoilt.bad;
    if (spoilt.bad) {
      EXPECT_TRUE(!bad_input(spoilt.problem).empty() || !is_positive_definite(spoilt.problem.M)) << spoilt.what;
    } else {
      EXPECT_EQ(bad_input(spoilt.problem), "") << spoilt.what;
    }
  }
  EXPECT_GT(bad, 300);
  EXPECT_LT(bad, 700);
}

}  // namespace
}  // namespace zwang
