// The field's methods on contacts with friction: what they claim holds.
#include <gtest/gtest.h>

#include <cstring>

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

TEST_P(FrictionMethods, WithoutFrictionTheyAreNotAsked) {
  Problem p = planted(Law::coulomb, 0.5, 1, 2, 0).problem;
  if (GetParam().name == std::string("cone")) GTEST_SKIP() << "it takes them";
  EXPECT_NE(make_solver(GetParam().name).supports(under(Law::frictionless, p)), "");
}

INSTANTIATE_TEST_SUITE_P(All, FrictionMethods,
                         testing::Values(Case{"nsgs", Law::coulomb, 30}, Case{"alart_curnier", Law::convex, 15},
                                         Case{"alart_curnier", Law::coulomb, 15}, Case{"admm", Law::convex, 30},
                                         Case{"admm", Law::coulomb, 25}, Case{"cone", Law::convex, 40},
                                         Case{"cone", Law::coulomb, 39}),
                         [](const auto& i) {
                           return std::string(i.param.name) + (i.param.law == Law::convex ? "_convex" : "_coulomb");
                         });

}  // namespace
}  // namespace zwang
