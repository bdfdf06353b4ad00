// The native exact methods without the shared polish (polish=off): what they claim of their own answers is true.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/newton/newton.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/brute_force.h"
#include "tests/solvers/random_mechanism.h"
#include "tests/solvers/yardsticks.h"

namespace zwang {
namespace {

using test::z_error;

class Alone : public testing::TestWithParam<std::string> {
 protected:
  AnySolver on = make_solver(GetParam()),
            off = make_solver(GetParam() + (with_settings() ? ",polish=off" : ":polish=off"));

 private:
  static bool with_settings() { return GetParam().find(':') != std::string::npos; }
};

// No worse than with it would be luck: errors of a few epsilons are neither's merit.
TEST_P(Alone, ClaimsOfSmallProblemsAreTrueAndTheErrorIsNoSmallerThanWithThePolish) {
  constexpr double luck = 1e-15;
  const SolveOptions options;
  int feasible = 0, solved = 0;
  for (unsigned seed = 1000; seed < 1300; ++seed) {
    const Problem p = random_small_problem(seed);
    const auto truth = brute_force(p);
    const Solution s = off.solve(p, options), polished = on.solve(p, options);
    if (!truth) {
      EXPECT_FALSE(claims_solved(s)) << p.name << " is infeasible";
      EXPECT_TRUE(s.status != Status::infeasible || certificate_holds(p, s.certificate, 1e-12)) << p.name;
      continue;
    }
    ++feasible;
    EXPECT_NE(s.status, Status::infeasible) << p.name;
    if (s.status != Status::solved) continue;
    ++solved;
    EXPECT_LE(z_error(p, s.z, truth->z), accepted_error(options.tolerance)) << p.name;
    EXPECT_LE(z_error(p, polished.z, truth->z), z_error(p, s.z, truth->z) + luck) << p.name;
    EXPECT_TRUE(s.handed_to.empty()) << p.name;
  }
  EXPECT_GE(solved, 0.95 * feasible) << "of " << feasible;
}

TEST_P(Alone, ClaimsOfMechanismsAreTrue) {
  int solved = 0;
  for (const test::Graph graph : test::graphs)
    for (unsigned seed = 0; seed < test::seeds(graph, 20); ++seed) {
      const Problem p = test::random_mechanism(graph, seed, 1);
      AnySolver exact = make_solver("dual_active_set");
      const Solution truth = exact.solve(p), s = off.solve(p);
      ASSERT_TRUE(claims_solved(truth)) << p.name;
      EXPECT_NE(s.status, Status::infeasible) << p.name;
      if (s.status != Status::solved || truth.status != Status::solved) continue;
      ++solved;
      EXPECT_LE(z_error(p, s.z, truth.z), accepted_error(SolveOptions().tolerance)) << p.name;
    }
  EXPECT_GE(solved, 75);
}

// Rows a and a + 2^-k d: sooner or later no method in double can tell, and must not say that it can.
TEST_P(Alone, NearlyDependentRowsAreNotClaimedWrongly) {
  for (int k = 4; k <= 50; ++k) {
    const double near = std::ldexp(1, -k);
    for (const std::size_t equalities : {0u, 2u}) {
      const Problem p = make_problem(Matrix{{1, 0, 0}, {1, near, 0}, {0, 0, 1}}, Vector{{1, 1 + near, -1}},
                                     Vec3(-0.3, 0.1, 0.7), equalities);
      const Solution s = off.solve(p), truth = on.solve(p);
      if (s.status != Status::solved || truth.status != Status::solved) continue;
      EXPECT_LE(z_error(p, s.z, truth.z), accepted_error(SolveOptions().tolerance)) << k << ", " << equalities;
    }
  }
}

TEST_P(Alone, SecondSolveAllocatesNothingAndGivesTheSameBits) {
  for (unsigned seed = 300; seed < 320; ++seed) {
    const Problem p = random_small_problem(seed);
    Solution first, second;
    off.solve(p, {}, first);
    off.solve(p, {}, second);
    const long before = allocations();
    off.solve(p, {}, second);
    EXPECT_EQ(allocations() - before, 0) << p.name;
    ASSERT_EQ(first.z.size(), second.z.size()) << p.name;
    EXPECT_EQ(std::memcmp(first.z.data(), second.z.data(), sizeof(double) * static_cast<std::size_t>(first.z.size())),
              0);
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Alone,
                         testing::Values("dual_active_set", "dual_active_set:reduce=off", "nnls", "nnls:reduce=on",
                                         "cholesky", "cholesky:reduce=on", "newton"),
                         [](const auto& i) {
                           std::string name = i.param;
                           for (char& c : name)
                             if (c == ':' || c == '=') c = '_';
                           return name;
                         });

// Where Newton's polish does not settle, the dual method answers, in its own iterations, and the solution says so.
TEST(HandedTo, NewtonNamesTheDualActiveSetAndGivesItsIterations) {
  const double near = 0x1p-25;
  const Problem p =
      make_problem(Matrix{{1, 0, 0}, {1, near, 0}, {0, 0, 1}}, Vector{{1, 1 + near, 1}}, Vec3(-0.3, 0.1, 0.7), 2);
  AnySolver newton = make_solver("newton"), exact = make_solver("dual_active_set"),
            alone = make_solver("newton:polish=off");
  const Solution s = newton.solve(p), truth = exact.solve(p);
  EXPECT_EQ(s.handed_to, "dual_active_set");
  EXPECT_EQ(s.iterations, truth.iterations);
  EXPECT_EQ(s.status, truth.status);
  EXPECT_TRUE(alone.solve(p).handed_to.empty());
}

}  // namespace
}  // namespace zwang
