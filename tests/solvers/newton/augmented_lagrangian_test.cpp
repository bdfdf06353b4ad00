// The augmented Lagrangian that `newton` minimizes, against its definition on the problem's own M, J, c.
#include <zwang/solvers/newton/augmented_lagrangian.h>

#include <gtest/gtest.h>

#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/newton/newton_polish.h>

#include "tests/parameter_name.h"

namespace zwang {
namespace {

class Lagrangians : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    problem_ = make_scenes(GetParam()).at(0).problem;
    ASSERT_TRUE(L_.rows.build(problem_));
    L_.begin(problem_, {}, Deadline(), 100);
    ASSERT_FALSE(L_.rests());
  }
  // 1/2 d'Md + 1/(2 s) sum of max(0, l + s (h - G d))^2.
  double value() {
    double sum = 0.5 * std::pow(L_.mass_norm(L_.d), 2);
    for (Index i = 0; i < L_.rows.rows(); ++i) {
      const double term = L_.l[i] + L_.s * L_.violation(i);
      if (L_.is_equality(i) || term > 0) sum += term * term / (2 * L_.s);
    }
    return sum;
  }
  void step() {
    L_.linearize();
    ASSERT_TRUE(L_.factorize(Deadline()));
    L_.step();
  }

  Problem problem_;
  AugmentedLagrangian L_;
};

TEST_P(Lagrangians, EachStepLeadsDownUntilTheRowsStay) {
  bool stays = false;
  for (int k = 0; k < 50 && !stays; ++k) {
    const double before = value();
    step();
    EXPECT_LE(value(), before * (1 + 1e-12));
    stays = L_.keeps_rows();
  }
  EXPECT_TRUE(stays);
  // At the minimum a step leads nowhere.
  const Vector d = L_.d;
  step();
  EXPECT_LE(L_.distance(d), 1e-9 * L_.scale);
}

TEST_P(Lagrangians, WhatIsWrittenHasTheResidualsOfTheIterate) {
  for (int k = 0; k < 3; ++k) step();
  L_.step_multipliers();
  VectorX<long double> force, violation;
  L_.residuals(L_.d.cast<long double>(), L_.l.cast<long double>(), force, violation);
  Solution s;
  L_.write(L_.d, L_.l, s);
  const Vector slack = problem_.J * s.z - problem_.c;
  for (Index i = 0; i < L_.rows.rows(); ++i) {
    const double own = std::ldexp(static_cast<double>(violation[i]), L_.rows.exponent) * L_.rows.row_norm[i];
    EXPECT_NEAR(own, -slack[L_.rows.row[at(i)]], 1e-10 * (1 + problem_.z_u.norm())) << i;
  }
  const Vector left = problem_.J.transpose() * s.lambda - problem_.M * (s.z - problem_.z_u);
  EXPECT_NEAR(std::ldexp(static_cast<double>(force.norm()), L_.rows.exponent), left.norm(), 1e-9 * (1 + left.norm()));
}

TEST_P(Lagrangians, ThePolishTakesTheResidualsDown) {
  Solution s;
  s.reset(problem_.size(), problem_.rows());
  double last = infinity, move = infinity;
  for (int outer = 0; outer < 30 && !(move <= 1e-5 * L_.scale); ++outer) {
    const Vector start = L_.d;
    for (int k = 0; k < 50; ++k) {
      step();
      if (L_.keeps_rows()) break;
    }
    L_.step_multipliers();
    last = move;
    move = L_.distance(start);
    if (last < infinity) L_.rate = move / last;
  }
  NewtonPolish polish;
  polish.alone = true;  // rows that others imply are no reason to ask another method
  ASSERT_TRUE(polish.run(L_, 1e-10, Deadline(), s));
  EXPECT_EQ(s.status, Status::solved);
  const Vector left = problem_.J.transpose() * s.lambda - problem_.M * (s.z - problem_.z_u);
  EXPECT_LE(left.norm(), 1e-12 * (problem_.M * problem_.z_u).norm());
}

// Pairs of rows a and a + 2^-8 d: under the first penalty an error shrinks to 0.4 or 0.5 a pass.
TEST(NewtonPolish, RaisesThePenaltyWhereRowsAllButRepeatEachOtherAndNoOtherMethodIsLeft) {
  for (const char* scene : {"NPI(k=8)", "NPE(k=8)"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    const Solution truth = AnySolver(DualActiveSet()).solve(p);
    for (const bool alone : {false, true}) {
      AugmentedLagrangian L;
      ASSERT_TRUE(L.rows.build(p));
      L.begin(p, {}, Deadline(), 100);
      L.hold_pushing(truth.z, truth.lambda, Deadline());
      NewtonPolish polish;
      polish.alone = alone;
      Solution s;
      s.reset(p.size(), p.rows());
      const double penalty = L.s;
      ASSERT_TRUE(polish.run(L, 1e-10, Deadline(), s)) << scene << " " << alone;
      EXPECT_EQ(L.s > penalty, alone) << scene;
      EXPECT_EQ(s.iterations > 0, alone) << scene;  // a factor for each
      EXPECT_EQ(s.status, Status::solved) << scene;
      EXPECT_LE((s.z - truth.z).norm(), 1e-14 * truth.z.norm()) << scene;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Newton, Lagrangians,
                         testing::Values("wall(boxes=25)", "tower(boxes=6)", "random(n=30,m=25,seed=4)"),
                         [](const auto& i) { return test::parameter_name(i.param); });

}  // namespace
}  // namespace zwang
