// Siconos' numerics behind the project's problems. Where it is absent there is nothing to test.
#include <gtest/gtest.h>

#include <zwang/solvers/registry.h>
#include "tests/solvers/friction/friction_problems.h"

namespace zwang {
namespace {

using test::law_error;
using test::planted;

constexpr bool is_global(std::string_view name) { return name.find("global") != name.npos; }

TEST(Siconos, WhatIsClaimedSolvedMeetsTheLaw) {
  if (!find_solver("siconos_nsn_fb")) GTEST_SKIP() << "Siconos is absent";
  for (const char* name :
       {"siconos_nsgs", "siconos_nsn_ac", "siconos_nsn_fb", "siconos_admm", "siconos_soclcp", "siconos_global_admm"}) {
    const Law law = std::string_view(name) == "siconos_soclcp" ? Law::convex : Law::coulomb;
    int solved = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
      const Problem p = planted(law, 0.5, 2, 3, seed).problem;
      AnySolver solver = make_solver(name);
      ASSERT_EQ(solver.supports(p), "") << name;
      const Solution s = solver.solve(p, {.tolerance = 1e-6});
      EXPECT_NE(s.status, Status::unsolved);
      if (s.status != Status::solved) continue;
      ++solved;
      EXPECT_LE(law_error(p, s), is_global(name) ? 1e-4 : 1e-5) << name << " " << seed << ": " << s.message;
    }
    EXPECT_GE(solved, 6) << name;
  }
}

TEST(Siconos, RowsThatItDoesNotKnowAreRefusedWithTheReason) {
  if (!find_solver("siconos_nsn_fb")) GTEST_SKIP() << "Siconos is absent";
  Problem p = planted(Law::coulomb, 0.5, 2, 3, 0).problem;
  EXPECT_NE(make_solver("siconos_soclcp").supports(p), "");  // of the convex law
  p.mu[0] = 0;
  EXPECT_NE(make_solver("siconos_nsgs").supports(p), "");
  p = planted(Law::coulomb, 0.5, 2, 3, 0).problem;
  p.kind[0] = p.kind[1] = p.kind[2] = RowKind::equality;
  p.mu[0] = 0;
  EXPECT_EQ(make_solver("siconos_nsgs").supports(p), "");
  EXPECT_NE(make_solver("siconos_global_admm").supports(p), "");
}

}  // namespace
}  // namespace zwang
