// The field's methods on contacts with friction: what they claim holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/friction/friction_problems.h"

namespace zwang {
namespace {

using test::law_error;
using test::planted;

struct Case {
  const char* name;
  Law law;
  int least;  // of 40 problems
};

class FrictionMethods : public testing::TestWithParam<Case> {};

TEST_P(FrictionMethods, WhatIsClaimedSolvedMeetsTheLaw) {
  const auto [name, law, least] = GetParam();
  int solved = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Problem p = planted(law, 0.5, 1 + static_cast<int>(seed % 3), 2 + static_cast<int>(seed % 4), seed).problem;
    AnySolver solver = make_solver(name);
    ASSERT_EQ(solver.supports(p), "") << name;
    const Solution s = solver.solve(p, {.tolerance = 1e-8});
    if (s.status != Status::solved) continue;
    ++solved;
    EXPECT_LE(law_error(p, s), 1e-6) << name << " " << seed;
  }
  EXPECT_GE(solved, least) << name;
}

TEST_P(FrictionMethods, TheSameBitsTwiceAndNothingAllocated) {
  const auto [name, law, least] = GetParam();
  const Problem p = planted(law, 0.5, 3, 6, 5).problem;
  AnySolver solver = make_solver(name);
  Solution first, second;
  solver.solve(p, {.max_iterations = 500}, first);
  solver.solve(p, {.max_iterations = 500}, second);
  const long before = allocations();
  solver.solve(p, {.max_iterations = 500}, second);
  EXPECT_EQ(allocations() - before, 0);
  ASSERT_EQ(first.status, second.status);
  EXPECT_EQ(
      0, std::memcmp(first.lambda.data(), second.lambda.data(), sizeof(double) * static_cast<std::size_t>(p.rows())));
}

// A block that comes down at 10 and slides at 4, in rows of any size, with any masses and friction: z = (n, t, 0).
TEST_P(FrictionMethods, NothingIsClaimedOfRowsOfOddSizes) {
  const auto [name, law, least] = GetParam();
  struct Odd {
    double size, mu, mass_n, mass_t;
  };
  for (const auto [size, mu, mass_n, mass_t] :
       {Odd{0x1p1000, .25, 1, 1}, Odd{0x1p-1000, .25, 1, 1}, Odd{1, 1e30, 1, 1}, Odd{1, 1e300, 1, 1},
        Odd{1, .25, 1e12, 1e-12}, Odd{1, .25, 1e-12, 1e12}}) {
    Vector masses(3), z_u(3), normal(3), t1(3), t2(3);
    masses << mass_n, mass_t, mass_t;
    z_u << -10, 4, 0;
    normal << size, 0, 0;
    t1 << 0, size, 0;
    t2 << 0, 0, size;
    const Problem p = test::friction_problem(
        masses, z_u, {{RowKind::inequality, normal, 0, mu}, {RowKind::tangent, t1, 0}, {RowKind::tangent, t2, 0}}, law);
    const Solution s = make_solver(name).solve(p, {.tolerance = 1e-8});
    if (s.status != Status::solved) continue;
    const double heavy = mass_n / mass_t, edge = law == Law::convex ? mu : 0;
    const double slip = std::max(0.0, 4 - mu * 10 * heavy) / (1 + edge * edge * heavy);
    Vector z(3);
    z << (slip > 0 ? edge * slip : 0), slip, 0;
    const Vector off = s.z - z;
    EXPECT_LE(std::sqrt(off.dot(p.M * off)), 1e-6 * std::sqrt(z_u.dot(p.M * z_u))) << name << " " << size << " " << mu;
  }
}

TEST_P(FrictionMethods, WithoutFrictionTheyAreNotAsked) {
  Problem p = planted(Law::coulomb, 0.5, 1, 2, 0).problem;
  if (GetParam().name == std::string("cone")) GTEST_SKIP() << "it takes them";
  EXPECT_NE(make_solver(GetParam().name).supports(under(Law::frictionless, p)), "");
}

INSTANTIATE_TEST_SUITE_P(All, FrictionMethods,
                         testing::Values(Case{"nsgs", Law::coulomb, 30}, Case{"alart_curnier", Law::convex, 15},
                                         Case{"alart_curnier", Law::coulomb, 15}, Case{"admm", Law::convex, 30},
                                         Case{"admm", Law::coulomb, 25}, Case{"cone", Law::convex, 40},
                                         Case{"cone", Law::coulomb, 39}, Case{"fixed_point", Law::coulomb, 30},
                                         Case{"fixed_point:inner=alart_curnier", Law::coulomb, 10},
                                         Case{"fixed_point:inner=cone:finish=off,relaxation=0.5", Law::coulomb, 20}),
                         [](const auto& i) {
                           std::string name = i.param.name;
                           std::ranges::replace_if(name, [](char c) { return std::isalnum(c) == 0; }, '_');
                           return name + (i.param.law == Law::convex ? "_convex" : "_coulomb");
                         });

std::string refusal(const char* text) {
  try {
    make_solver(text);
  } catch (const std::invalid_argument& wrong) {
    return wrong.what();
  }
  return "";
}

TEST(FixedPoint, TakesSolversOfTheConvexLawAlone) {
  EXPECT_NE(refusal("fixed_point:inner=nsgs").find("should be a solver of the convex law: "), std::string::npos);
  EXPECT_NE(refusal("fixed_point:inner=kone").find("convex law"), std::string::npos);
  EXPECT_NE(refusal("fixed_point:inner=fixed_point"), "");
  EXPECT_NE(refusal("fixed_point:inner=cone:finnish=off").find("did you mean 'finish'?"), std::string::npos);
  EXPECT_NE(refusal("fixed_point:relaxation=0").find("above 0"), std::string::npos);
  EXPECT_FALSE(runs_apart("fixed_point"));
  EXPECT_TRUE(runs_apart("fixed_point:max_rounds=3,inner=ipopt"));
}

// Sparse rows: a pile, with the answer that `cone` finds, from nothing and from that answer.
TEST(Nsgs, TakesPilesAndWarmStarts) {
  const Problem p = make_scenes("pile(spheres=60,mu=0.5)").at(0).problem;
  const Solution truth = make_solver("cone").solve(p);
  ASSERT_EQ(truth.status, Status::solved);
  AnySolver solver = make_solver("nsgs");
  Solution s, again;
  solver.solve(p, {.tolerance = 1e-8}, s);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE((s.z - truth.z).norm(), 1e-6 * truth.z.norm());
  const WarmStart warm{.key = p.key, .lambda = truth.lambda};
  solver.solve(p, {.tolerance = 1e-8, .warm_start = &warm}, again);
  ASSERT_EQ(again.status, Status::solved) << again.message;
  EXPECT_LT(again.iterations, s.iterations);
  const long before = allocations();
  solver.solve(p, {.tolerance = 1e-8}, again);
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_EQ(again.z, s.z);
  const WarmStart absurd{.key = p.key, .lambda = Vector::Constant(p.rows(), 1e12)};
  solver.solve(p, {.tolerance = 1e-8, .warm_start = &absurd}, again);
  EXPECT_EQ(again.z, s.z);
}

// A sliding block meets Coulomb's law in a few rounds: it stays on the ground, where the convex law lifts it.
TEST(FixedPoint, TakesTheLiftOfTheConvexLawBack) {
  const Problem p = test::friction_problem(Vector::Ones(3), Vec3(-8, 6, 8),
                                           {{RowKind::inequality, Vec3(1, 0, 0), 0, 0.5},
                                            {RowKind::tangent, Vec3(0, 1, 0), 0},
                                            {RowKind::tangent, Vec3(0, 0, 1), 0}});
  const Solution s = make_solver("fixed_point").solve(p, {.tolerance = 1e-10});
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE((s.z - Vec3(0, 3.6, 4.8)).norm(), 1e-9);
  EXPECT_GT(s.iterations, 1);
  const Solution stopped = make_solver("fixed_point:max_rounds=2").solve(p, {.tolerance = 1e-10});
  EXPECT_EQ(stopped.status, Status::iteration_limit);
  EXPECT_NE(stopped.message.find("residual stays"), std::string::npos);
  EXPECT_EQ(make_solver("fixed_point").solve(p, {.time_limit = 0}).status, Status::time_limit);
}

// Plates that part along themselves have no convex answer, and many under Coulomb's law.
TEST(FixedPoint, GoesOnWhereTheConvexLawHasNoAnswer) {
  const Vector right{{1, 0}}, left{{-1, 0}}, up{{0, 1}};
  const Problem pinch = test::friction_problem(Vector::Ones(2), Vector{{0, 3}},
                                               {{RowKind::inequality, right, 0, 1},
                                                {RowKind::tangent, up, 1},
                                                {RowKind::inequality, left, 0, 1},
                                                {RowKind::tangent, up, -1}});
  const Solution s = make_solver("fixed_point").solve(pinch, {.tolerance = 1e-8});
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE(law_error(pinch, s), 1e-7);
}

}  // namespace
}  // namespace zwang
