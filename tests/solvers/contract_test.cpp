// One battery for every solver of the registry: a new solver is picked up by itself. The yardsticks here (brute force,
// certificates by hand) are independent of the referee. What a method cannot do by its nature stands in
// the registry; everything else holds for all.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>

#include <zwang/bench/timing/allocations.h>
#include <zwang/core/problem/solver.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/brute_force.h"
#include "tests/solvers/yardsticks.h"

namespace zwang {
namespace {

using test::z_error;

Problem opposed_contacts() { return make_problem(Matrix{{1, 0, 0}, {-1, 0, 0}}, Vector{{1, 0}}, Vec3(0, 0, 0)); }
Problem contradicting_joints() { return make_problem(Matrix{{1, 2, 0}, {2, 4, 0}}, Vector{{1, 3}}, Vec3(0, 0, 0), 2); }
Problem zero_row_above_zero() { return make_problem(Matrix{{0, 0, 0}, {0, 0, 1}}, Vector{{1e-12, 0}}, Vec3(1, 2, -3)); }

class Contract : public testing::TestWithParam<std::string> {
 protected:
  const SolverEntry& entry = *find_solver(GetParam());
  AnySolver solver = make_solver(GetParam());
  const SolveOptions options{.tolerance = entry.accuracy.tolerance,
                             .max_iterations = entry.creeps ? 1000 : SolveOptions().max_iterations};

  // Empty when the method applies; else the reason, for GTEST_SKIP.
  std::string unsupported(const Problem& p) const { return solver.supports(p); }

  void expect_z(const Problem& p, const Vector& truth) {
    if (const std::string reason = unsupported(p); !reason.empty()) GTEST_SKIP() << reason;
    const Solution s = solver.solve(p, options);
    EXPECT_TRUE(claims_solved(s)) << to_string(s.status) << ": " << s.message;
    EXPECT_LE(z_error(p, s.z, truth), entry.accuracy.z_error) << "z = " << s.z.transpose();
    for (Index i = 0; i < p.rows() && s.lambda.size() == p.rows(); ++i)
      EXPECT_TRUE(p.is_equality(i) || s.lambda[i] >= -entry.accuracy.z_error)
          << "lambda(" << i << ") = " << s.lambda[i];
  }

  void expect_infeasible(const Problem& p) {
    if (const std::string reason = unsupported(p); !reason.empty()) GTEST_SKIP() << reason;
    if (entry.needs_range) GTEST_SKIP() << "the method cannot see infeasibility (docs/formulation.md, gap 2)";
    const Solution s = solver.solve(p, options);
    EXPECT_TRUE(!claims_solved(s) || !entry.sees_infeasibility) << "z = " << s.z.transpose();
    EXPECT_NE(s.status, Status::unsolved);
    if ((s.status == Status::infeasible && entry.proves_infeasibility) || entry.exact) {
      EXPECT_EQ(s.status, Status::infeasible) << to_string(s.status) << ": " << s.message;
      EXPECT_TRUE(certificate_holds(p, s.certificate, entry.accuracy.certificate))
          << "u = " << s.certificate.transpose();
    }
  }
};

TEST_P(Contract, NoRowsLeaveTheMotionUnconstrained) {
  const Problem p = make_problem(Matrix(0, 3), Vector(0), Vec3(1, -2, 3));
  expect_z(p, p.z_u);
}

TEST_P(Contract, InactiveRowLeavesTheMotionUnconstrained) {
  const Problem p = make_problem(Matrix{{1, 1, 0}}, Vector{{-5}}, Vec3(1, -2, 3));
  expect_z(p, p.z_u);
}

TEST_P(Contract, ActiveRowStopsTheMotion) {
  const Problem p = make_problem(Matrix{{0, 0, 1}}, Vector{{0}}, Vec3(1, 2, -10));
  expect_z(p, Vec3(1, 2, 0));
}

TEST_P(Contract, EqualityRowPullsAsWellAsPushes) {
  for (const double c : {-4.0, 4.0}) {
    const Problem p = make_problem(Matrix{{0, 2, 0}}, Vector{{c}}, Vec3(1, 0, -1), 1);
    expect_z(p, Vec3(1, c / 2, -1));
  }
}

TEST_P(Contract, DuplicatedRowsGiveTheSameMotion) {
  const Matrix J{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 2}};
  const Problem p = make_problem(J, Vector{{1, 0, 0, 0}}, Vec3(0, 2, -10), 1);
  expect_z(p, Vec3(1, 2, 0));
}

TEST_P(Contract, DuplicatedEqualityRowsGiveTheSameMotion) {
  const Matrix J{{1, 1, 0}, {2, 2, 0}, {0, 0, 1}};
  const Problem p = make_problem(J, Vector{{1, 2, 3}}, Vec3(0, 0, 0), 2);
  if (entry.needs_rank && !claims_solved(solver.solve(p, options))) GTEST_SKIP() << "gives up on dependent rows";
  expect_z(p, Vec3(0.6, 0.4, 3));
}

TEST_P(Contract, OpposedContactsAreInfeasible) { expect_infeasible(opposed_contacts()); }

TEST_P(Contract, ContradictingJointsAreInfeasible) { expect_infeasible(contradicting_joints()); }

TEST_P(Contract, ZeroRowThatHoldsIsDropped) {
  const Problem p = make_problem(Matrix{{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}, Vector{{0, -1, 0}}, Vec3(1, 2, -3), 1);
  expect_z(p, Vec3(1, 2, 0));
}

TEST_P(Contract, ZeroRowThatCannotHoldIsInfeasible) {
  expect_infeasible(zero_row_above_zero());
  expect_infeasible(make_problem(Matrix{{0, 0, 0}, {0, 0, 1}}, Vector{{-1, 0}}, Vec3(1, 2, -3), 1));
}

TEST_P(Contract, NotANumberIsBadInput) {
  Problem p = make_problem(Matrix{{0, 0, 1}}, Vector{{0}}, Vec3(1, 2, -3));
  p.J.coeffRef(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solver.solve(p, options).status, Status::bad_input);
}

TEST_P(Contract, IndefiniteMassIsBadInput) {
  Problem p = make_problem(Matrix{{0, 0, 1}}, Vector{{0}}, Vec3(1, 2, -3));
  p.M.coeffRef(1, 1) = -1;
  if (const std::string reason = unsupported(p); !reason.empty()) GTEST_SKIP() << reason;
  EXPECT_EQ(solver.solve(p, options).status, Status::bad_input);
}

TEST_P(Contract, MinusInfinityMakesARowInactiveForGood) {
  const Problem p = make_problem(Matrix{{1, 0, 0}, {0, 0, 1}}, Vector{{-std::numeric_limits<double>::infinity(), 0}},
                                 Vec3(-1, 2, -3));
  expect_z(p, Vec3(-1, 2, 0));
}

TEST_P(Contract, OneIterationIsNotClaimedSolvedUnlessItIs) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Problem p = random_small_problem(seed);
    const auto truth = brute_force(p);
    if (!truth || !unsupported(p).empty() || entry.needs_range) continue;
    SolveOptions one = options;
    one.max_iterations = 1;
    const Solution s = solver.solve(p, one);
    EXPECT_NE(s.status, Status::infeasible) << p.name;
    if (!claims_solved(s)) continue;
    EXPECT_LE(z_error(p, s.z, truth->z), entry.accuracy.z_error) << p.name;
  }
}

TEST_P(Contract, WarmStartGivesTheSameMotion) {
  for (unsigned seed = 100; seed < 120; ++seed) {
    const Problem p = random_small_problem(seed);
    if (!unsupported(p).empty()) continue;
    const Solution cold = solver.solve(p, options);
    if (!claims_solved(cold)) continue;
    WarmStart warm{.key = p.key, .lambda = cold.lambda};
    SolveOptions warm_options = options;
    warm_options.warm_start = &warm;
    const auto near_cold = [&](const Solution& s) {
      EXPECT_TRUE(claims_solved(s)) << p.name << ": " << to_string(s.status);
      EXPECT_LE(z_error(p, s.z, cold.z), 2 * entry.accuracy.z_error) << p.name;
    };
    near_cold(solver.solve(p, warm_options));
    // A stale guess: every multiplier at one, and keys that no row has any more.
    warm.lambda.setOnes(p.rows());
    if (p.rows() > 0) warm.key[0].constraint = 999;
    near_cold(solver.solve(p, warm_options));
    // Multipliers of no motion at all.
    for (const double length : {1e10, 1e200, std::numeric_limits<double>::quiet_NaN()}) {
      warm = {.key = p.key, .lambda = Vector::Constant(p.rows(), length)};
      near_cold(solver.solve(p, warm_options));
    }
  }
}

TEST_P(Contract, SameBitsTwice) {
  for (unsigned seed = 200; seed < 220; ++seed) {
    const Problem p = random_small_problem(seed);
    if (!unsupported(p).empty()) continue;
    const Solution first = solver.solve(p, options), second = solver.solve(p, options);
    const Solution fresh = make_solver(GetParam()).solve(p, options);
    for (const Solution* s : {&second, &fresh}) {
      EXPECT_EQ(first.status, s->status) << p.name;
      ASSERT_EQ(first.z.size(), s->z.size()) << p.name;
      EXPECT_EQ(std::memcmp(first.z.data(), s->z.data(), sizeof(double) * static_cast<std::size_t>(first.z.size())), 0)
          << p.name << ": " << (first.z - s->z).transpose();
    }
  }
}

TEST_P(Contract, SecondSolveOfTheSameShapeAllocatesNothing) {
  if (entry.foreign) GTEST_SKIP() << "foreign: the library's own affair";
  std::vector<Problem> problems = {opposed_contacts(), contradicting_joints(), zero_row_above_zero()};
  for (unsigned seed = 300; seed < 330; ++seed) problems.push_back(random_small_problem(seed));
  for (const Problem& p : problems) {
    if (!unsupported(p).empty()) continue;
    Solution s;
    solver.solve(p, options, s);
    const long before = allocations();
    solver.solve(p, options, s);
    EXPECT_EQ(allocations() - before, 0) << p.name << ", " << p.size() << " unknowns, " << p.rows() << " rows";
  }
}

TEST_P(Contract, AgreesWithEnumerationOverActiveSets) {
  int feasible = 0, solved = 0;
  for (unsigned seed = 1000; seed < 1300; ++seed) {
    const Problem p = random_small_problem(seed);
    if (!unsupported(p).empty() || (entry.needs_range && !in_range(p))) continue;
    const auto truth = brute_force(p);
    const Solution s = solver.solve(p, options);
    if (!truth) {
      EXPECT_TRUE(!claims_solved(s) || !entry.sees_infeasibility) << p.name << " is infeasible";
      EXPECT_TRUE(s.status != Status::infeasible || !entry.proves_infeasibility ||
                  certificate_holds(p, s.certificate, entry.accuracy.certificate))
          << p.name;
      continue;
    }
    ++feasible;
    EXPECT_NE(s.status, Status::infeasible) << p.name;
    if (!claims_solved(s)) continue;
    ++solved;
    EXPECT_LE(z_error(p, s.z, truth->z), entry.accuracy.z_error) << p.name;
  }
  if (feasible == 0) GTEST_SKIP() << "no problem of this kind is supported";
  EXPECT_GE(solved, entry.accuracy.solved_share * feasible) << "of " << feasible;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const SolverEntry& e : solvers()) all.push_back(e.name);
  return all;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Contract);
INSTANTIATE_TEST_SUITE_P(Solvers, Contract, testing::ValuesIn(names()), [](const auto& i) { return i.param; });

}  // namespace
}  // namespace zwang
