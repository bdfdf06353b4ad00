#include <zwang/solvers/rivals/ipopt.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include <zwang/core/problem/cpu_clock.h>
#include <zwang/solvers/ipopt/ipopt_method.h>
#include "tests/solvers/friction/friction_problems.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::solve;

// M z_0 = 0 twice over two unknowns: three equality rows, rank 2.
Problem overdetermined(double last) {
  return test::make_problem(test::vec({1, 2}), test::vec({3, 5}),
                            {{RowKind::equality, test::vec({1, 0}), 1},
                             {RowKind::equality, test::vec({0, 1}), 2},
                             {RowKind::equality, test::vec({1, 1}), last}});
}

TEST(Ipopt, PullsThroughAnEqualityRow) {
  const Problem p = test::tied_pair();
  const Solution s = solve<Ipopt>(p);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE(test::z_error(p, s.z, test::vec({0, 0})), 1e-10);
  EXPECT_NEAR(s.lambda[0], -40, 1e-7);
  EXPECT_NEAR(s.lambda[1], 50, 1e-7);
}

TEST(Ipopt, CarriesATowerOfLargeMassRatio) {
  const Problem p = test::tower(10, 1048576);
  const Solution s = solve<Ipopt>(p, {.tolerance = 1e-12});
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE(test::z_error(p, s.z, Vector::Zero(10)), 1e-11);
}

TEST(Ipopt, MeetsTheToleranceAskedForOnAWeaklyActiveRow) {
  // z = z_u touches the row with no force on it: lambda slack <= T alone would let z off by sqrt(T).
  const Problem p =
      test::make_problem(test::vec({1, 1}), test::vec({0, 1}), {{RowKind::inequality, test::vec({1, 0}), 0}});
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    const Solution s = solve<Ipopt>(p, {.tolerance = tolerance});
    ASSERT_EQ(s.status, Status::solved) << s.message;
    EXPECT_LE(test::z_error(p, s.z, p.z_u), 10 * tolerance);
  }
}

TEST(Ipopt, DropsAConsistentDependentEqualityRowAndNamesIt) {
  const Problem p = overdetermined(3);
  const Solution s = solve<Ipopt>(p);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_EQ(s.redundant.size(), 1u);
  EXPECT_LE(test::z_error(p, s.z, test::vec({1, 2})), 1e-10);
}

TEST(Ipopt, CertifiesAContradictionAmongEqualityRows) {
  const Problem p = overdetermined(3.5);
  const Solution s = solve<Ipopt>(p);
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_LE(test::farkas_residual(p, s.certificate), 1e-12);
}

TEST(Ipopt, DetectsAConflictOfInequalityRows) {
  const Solution s = solve<Ipopt>(test::squeezed());
  ASSERT_EQ(s.status, Status::infeasible) << s.message;
  EXPECT_LE(test::farkas_residual(test::squeezed(), s.certificate), 1e-8);
}

TEST(Ipopt, CertifiesAZeroRowThatCannotHold) {
  const Solution s = solve<Ipopt>(test::zero_row_conflict());
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_EQ(s.certificate, test::vec({1}));
}

TEST(Ipopt, ReturnsTheUnconstrainedMotionWithoutRows) {
  const Problem p = test::make_problem(test::vec({1, 2}), test::vec({3, 5}), {});
  const Solution s = solve<Ipopt>(p);
  ASSERT_EQ(s.status, Status::solved);
  EXPECT_EQ(s.z, p.z_u);
}

TEST(Ipopt, StopsAtTheSmallerOfItsTwoLimits) {
  Ipopt two;
  two.max_iterations = 2;
  EXPECT_EQ(solve(test::tower(10), {}, two).status, Status::iteration_limit);
  const Solution s = solve<Ipopt>(test::tower(10), {.max_iterations = 1});
  EXPECT_EQ(s.status, Status::iteration_limit);
  EXPECT_EQ(s.iterations, 1);
  EXPECT_EQ(s.z.size(), 10);
}

TEST(Ipopt, StopsAtItsTimeLimit) {
  EXPECT_EQ(solve<Ipopt>(test::tower(10), {.time_limit = 0}).status, Status::time_limit);
}

TEST(Ipopt, ShowsItsIteratesToAnObserver) {
  const Problem p = test::tower(10);
  std::vector<double> errors;
  const SolveOptions options{
      .observe = [&](int, const Vector& z, const Vector&) { errors.push_back(test::z_error(p, z, Vector::Zero(10))); }};
  const Solution s = solve<Ipopt>(p, options);
  ASSERT_EQ(s.status, Status::solved);
  ASSERT_EQ(errors.size(), static_cast<std::size_t>(s.iterations + 1));
  EXPECT_LT(errors.back(), 1e-8);
  EXPECT_GT(errors.front(), errors.back());
}

TEST(Ipopt, AnswersAsItWouldInThisProgramAndTakesItsTime) {
  for (const Problem& p : {test::tower(10, 1048576), overdetermined(3), overdetermined(3.5), test::squeezed()}) {
    const double start = thread_cpu_seconds();
    const Solution there = solve<Ipopt>(p), here = solve<IpoptMethod>(p);
    EXPECT_GT(thread_cpu_seconds(), start);
    EXPECT_EQ(there.status, here.status);
    EXPECT_EQ(there.z, here.z);
    EXPECT_EQ(there.lambda, here.lambda);
    EXPECT_EQ(there.certificate, here.certificate);
    EXPECT_EQ(there.redundant, here.redundant);
    EXPECT_EQ(there.message, here.message);
    EXPECT_EQ(there.iterations, here.iterations);
  }
}

TEST(Ipopt, WithoutItsProgramSaysSo) {
  setenv("ZWANG_IPOPT", "/nowhere", 1);
  const Solution s = AnySolver(Ipopt()).solve(test::tower(2));
  unsetenv("ZWANG_IPOPT");
  EXPECT_EQ(s.status, Status::unsupported);
  EXPECT_EQ(s.message, "the program zwang-ipopt is not there; expected in PATH, or as ZWANG_IPOPT in the environment");
}

TEST(Ipopt, ADeadProgramIsACrashAndTheNextQuestionStartsAnother) {
  setenv("ZWANG_IPOPT", "/bin/false", 1);
  AnySolver solver = Ipopt();
  EXPECT_EQ(solver.solve(test::tower(2)).status, Status::crashed);
  unsetenv("ZWANG_IPOPT");
  EXPECT_EQ(solver.solve(test::tower(2)).status, Status::solved);
}

// Licences: what is under the EPL and what is under the GPL never meet in one program.
TEST(Ipopt, ItsProgramLinksNothingUnderTheGpl) {
  const auto libraries = [](const std::string& program) {
    std::string text;
    if (FILE* const pipe = popen(("ldd " + program).c_str(), "r")) {
      for (char line[512]; std::fgets(line, sizeof line, pipe);) text += line;
      pclose(pipe);
    }
    return text;
  };
  const std::string program = find_program("zwang-ipopt");
  ASSERT_FALSE(program.empty());
  const std::string of_ipopt = libraries(program);
  EXPECT_NE(of_ipopt.find("libipopt"), std::string::npos) << of_ipopt;
  EXPECT_EQ(of_ipopt.find("libcholmod"), std::string::npos) << of_ipopt;
  EXPECT_EQ(of_ipopt.find("libspqr"), std::string::npos) << of_ipopt;
}

TEST(Ipopt, PrintsNothing) {
  testing::internal::CaptureStdout();
  solve<Ipopt>(test::tower(5));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(KktResidual, SeesWhatAProductOfMultiplierAndSlackHides) {
  const Problem p = test::make_problem(test::vec({1}), test::vec({1}), {{RowKind::inequality, test::vec({1}), 1}});
  UnitProgram program;
  Solution solution;
  ASSERT_TRUE(program.build(p, {}, solution));
  const Vector small = test::vec({1e-5});
  EXPECT_GT(program.kkt_residual(small, small), 1e-6);      // lambda slack = 1e-10, yet both are 1e-5
  EXPECT_GT(program.kkt_residual(small, 2 * small), 1e-6);  // y is not G'lambda
}

// Contacts with friction as squares. Where contacts stick the squares have no gradient: what is claimed still holds.
TEST(Ipopt, WhatItClaimsOfConesMeetsTheConvexLaw) {
  int solved = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto [p, z, lambda] = test::planted(Law::convex, 0.5, 2, 4, seed);
    const Solution s = solve<Ipopt>(p, {.tolerance = 1e-6});
    EXPECT_NE(s.status, Status::unsupported) << s.message;
    if (s.status != Status::solved) continue;
    ++solved;
    EXPECT_LE(test::z_error(p, s.z, z), 1e-5) << seed;
    EXPECT_LE(test::law_error(p, s), 1e-4) << seed;
  }
  EXPECT_GE(solved, 10);
  const Problem coulomb = test::planted(Law::coulomb, 0.5, 2, 4, 0).problem;
  EXPECT_EQ(AnySolver(Ipopt()).solve(coulomb).status, Status::unsupported);
}

}  // namespace
}  // namespace zwang
