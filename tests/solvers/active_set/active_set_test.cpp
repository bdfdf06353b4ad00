// What the active-set methods promise beyond the contract: digits on ill-conditioned rows, certificates at tiny gaps,
// and the truths of the stored problems.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cstdlib>
#include <filesystem>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/registry.h>
#include "tests/parameter_name.h"
#include "tests/recorded_data.h"

namespace zwang {
namespace {

Problem unit_mass(const Matrix& J, const Vector& c, const Vector& z_u, Index equalities) {
  Problem p{.name = "unit mass"};
  p.M.resize(z_u.size(), z_u.size());
  p.M.setIdentity();
  p.z_u = z_u;
  p.J = J.sparseView();
  p.c = c;
  for (Index i = 0; i < c.size(); ++i) {
    p.kind.push_back(i < equalities ? RowKind::equality : RowKind::inequality);
    p.key.push_back({.constraint = static_cast<std::uint64_t>(i), .row = 0});
  }
  return p;
}

class ActiveSet : public testing::TestWithParam<const char*> {
 protected:
  AnySolver solver = make_solver(GetParam());
};

// Two joints whose rows differ by e: z is e-independent, and right as long as the rows can be told apart.
TEST_P(ActiveSet, NearParallelJointsKeepTheirDigits) {
  for (int k = 3; k <= 24; ++k) {
    const double e = std::ldexp(1.0, -k);
    const Vec3 z0(1, -2, 4);
    const Matrix J{{1, 2, 2}, {1 + e, 2 - e, 2}};
    const Problem p = unit_mass(J, J * z0, Vec3(1, -2, 3.5), 2);  // z0 - z_u lies outside the rows' span
    const Solution s = solver.solve(p);
    ASSERT_EQ(s.status, Status::solved) << "e = 2^-" << k << ": " << to_string(s.status) << ", " << s.message;
    EXPECT_LE((J * s.z - p.c).norm(), 1e-14) << "e = 2^-" << k;
    // The one free direction is orthogonal to both rows: z = z_u + the least-norm correction.
    const Vec3 free = Vec3(J.row(0)).cross(Vec3(J.row(1))).normalized();
    EXPECT_NEAR((s.z - p.z_u).dot(free), 0, 1e-11) << "e = 2^-" << k;
  }
}

// Rows whose sum is zero: feasible exactly when their c add up to nothing positive.
TEST_P(ActiveSet, TellsAGapOfOnePartInTenToTheTwelve) {
  const Matrix J{{1, 0}, {0, 1}, {-1, -1}};
  for (int k = 3; k <= 40; ++k) {
    const double gap = std::ldexp(1.0, -k);
    const Solution open = solver.solve(unit_mass(J, Vec3(1, 1, -2 - gap), Vector{{0, 0}}, 0));
    EXPECT_EQ(open.status, Status::solved) << "gap = 2^-" << k;
    const Problem closed = unit_mass(J, Vec3(1, 1, -2 + gap), Vector{{0, 0}}, 0);
    const Solution s = solver.solve(closed);
    EXPECT_EQ(s.status, Status::infeasible) << "gap = -2^-" << k;
    EXPECT_EQ(measure(closed, s, nullptr, 1e-10).verdict, Verdict::infeasible_proven) << "gap = -2^-" << k;
  }
}

// z = (1, 0) lies 2^k openings away, and no other length stands beside it: far, but there.
TEST_P(ActiveSet, AWedgeWithNothingToCompareItWithIsFeasible) {
  for (int k = 20; k <= 46; ++k) {
    const double opening = std::ldexp(1.0, -k);
    const Problem p = unit_mass(Matrix{{0, 1}, {opening, -1}}, Vector{{0, opening}}, Vector{{0, 0}}, 0);
    const Solution s = solver.solve(p);
    EXPECT_EQ(s.status, Status::solved) << "opening 2^-" << k;
    ASSERT_EQ(s.z.size(), 2) << "opening 2^-" << k;
    EXPECT_LE((s.z - Vector{{1, 0}}).norm(), 1e-12) << "opening 2^-" << k;
  }
}

// 2^-39 from a contradiction, and met 2^44 along a body of 2^16, beside which a mass of 2^-15 makes that difference
// less than rounding of whitened rows. No answer is asked for that far away, but no proof that there is none.
TEST_P(ActiveSet, RowsThatMeetFarAlongAHeavyBodyAreNoContradiction) {
  const double e = 0x1p-39;
  const Matrix J{{2, 1, 3}, {e - 5, 2 + e, -3}, {1, 0, 1}};
  Problem p = unit_mass(J, Vec3(0, 3, 3), Vec3(4, 2, 2), 1);
  p.M.diagonal() = Vec3(0x1p-15, 0x1p16, 0x1p-10);
  const Vec3 slack = J * Vec3(0x1p44 + 9, 0x1p44, -0x1p44 - 6) - p.c;
  ASSERT_EQ(slack[0], 0);
  ASSERT_GE(slack.minCoeff(), 0);
  const Solution s = solver.solve(p);
  EXPECT_NE(s.status, Status::infeasible);
}

// 2^-46 from a contradiction beside entries of 6: more than a rounding of each row leaves.
TEST_P(ActiveSet, RowsThatMeetAtTwoToTheFortySevenAreNoContradiction) {
  const Matrix J{{-3, 0}, {6, -0x1p-46}};
  Problem p = unit_mass(J, Vector{{-2, 6}}, Vector{{-4, 3}}, 1);
  p.M.diagonal() = Vector{{0x1p18, 0x1p17}};
  const Solution s = solver.solve(p);
  EXPECT_NE(s.status, Status::infeasible);
  p.J.coeffRef(1, 1) = -0x1p-52;  // less than a rounding: taken for 0
  EXPECT_EQ(solver.solve(p).status, Status::infeasible);
}

// A finger that is welded where a joint's limit is beyond reach: the welded and the jointed rows agree to rounding
// only.
TEST_P(ActiveSet, ProvesALimitAgainstAWeldThatRepeatsAJoint) {
  const Problem hand = make_scenes("hand(limits=20,drift=0,contacts=16,locked=1)").at(0).problem;
  const Solution s = solver.solve(hand);
  EXPECT_EQ(s.status, Status::infeasible) << s.message;
  EXPECT_EQ(measure(hand, s, nullptr, 1e-10).verdict, Verdict::infeasible_proven);
}

TEST_P(ActiveSet, NamesTheRedundantRows) {
  const Matrix J{{1, 1, 0}, {2, 2, 0}, {0, 0, 1}, {0, 0, 3}};
  const Solution s = solver.solve(unit_mass(J, Vector{{1, 2, 0, 0}}, Vec3(0, 0, -1), 2));
  EXPECT_EQ(s.status, Status::solved);
  ASSERT_EQ(s.redundant.size(), 2u);
  EXPECT_EQ(s.redundant[0], 1);
  EXPECT_EQ(s.margins.rank, 2);
}

TEST_P(ActiveSet, GivesMultipliersThatBalanceTheMotion) {
  const Matrix J{{1, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  const Problem p = unit_mass(J, Vector{{1, 0, -5}}, Vec3(0, 0, -1), 1);
  const Solution s = solver.solve(p);
  EXPECT_LE((s.z - p.z_u - J.transpose() * s.lambda).norm(), 1e-15);
  EXPECT_EQ(s.lambda[2], 0);
}

TEST_P(ActiveSet, StopsAtItsTimeLimit) {
  const Solution s = solver.solve(unit_mass(Matrix{{1, 0}}, Vector{{1}}, Vector{{0, 0}}, 0), {.time_limit = 0});
  EXPECT_EQ(s.status, Status::time_limit);
}

// Hands, towers, duplicated and near-parallel rows, mass ratios, infeasible limits, 300 hands under stress: truths from
// a 100-digit solve.
TEST_P(ActiveSet, AgreesWithTheStoredTruths) {
  const std::filesystem::path data = test::recorded_data();
  if (!std::filesystem::exists(data / "problems")) GTEST_SKIP() << "no " << data / "problems";
  int compared = 0;
  for (const char* file : {"H4", "H16", "H64", "H200", "K1", "K2", "tower10", "dup3_H64", "mr1e0", "mr1e2", "mr1e4",
                           "mr1e6", "infeas_lim", "tight_feas", "stress", "nearpar1e-10"})
    for (const Instance& instance : read_problems(data / "problems" / (std::string(file) + ".h5"))) {
      ASSERT_TRUE(instance.reference) << instance.problem.name;
      const Solution s = solver.solve(instance.problem);
      const Metrics found = measure(instance.problem, s, &*instance.reference, 1e-13);
      EXPECT_EQ(found.verdict, instance.reference->feasible ? Verdict::solved : Verdict::infeasible_proven)
          << instance.problem.name << ": " << to_string(s.status) << ", " << s.message << ", z_error " << found.z_error;
      ++compared;
    }
  EXPECT_GE(compared, 350);
}

INSTANTIATE_TEST_SUITE_P(Solvers, ActiveSet,
                         testing::Values("nnls", "nnls:reduce=on", "cholesky", "cholesky:reduce=on"),
                         [](const auto& i) { return test::parameter_name(i.param); });

// c in the range of J: right. Outside: wrong, and the message says how far outside.
TEST(NnlsPaper, IsRightWhereKExists) {
  const Problem p = unit_mass(Matrix{{1, 0, 0}, {0, 0, 1}}, Vector{{2, -1}}, Vec3(0, 3, -10), 1);
  const Solution s = make_solver("nnls_paper").solve(p);
  EXPECT_EQ(s.status, Status::solved);
  EXPECT_LE((s.z - Vec3(2, 3, -1)).norm(), 1e-15);
  EXPECT_EQ(s.message.substr(0, 10), "range gap ");
  EXPECT_LE(std::stod(s.message.substr(10)), 1e-15);
}

TEST(NnlsPaper, IsWrongAndSaysWhyOutsideTheRange) {
  // z >= 1 and z >= 3 are one inequality; no k meets both as equalities, and least squares takes k = 2.
  const Problem p = unit_mass(Matrix{{1}, {1}}, Vector{{1, 3}}, Vector{{0}}, 0);
  const Solution s = make_solver("nnls_paper").solve(p);
  EXPECT_EQ(s.status, Status::solved);
  EXPECT_NEAR(s.z[0], 2, 1e-15);
  EXPECT_EQ(s.message, "range gap 4.5e-01");  // sqrt(2) / sqrt(10)
}

// Two floors under one body, the higher one far below where it comes to rest: c lies outside the range of J, yet the
// rows that push keep their c, and z is right.
TEST(NnlsPaper, AGapOnRowsThatDoNotPushLeavesZRight) {
  const Problem p = unit_mass(Matrix{{1, 0}, {0, 1}, {0, 1}}, Vector{{1, -3, -2}}, Vector{{0, 5}}, 0);
  const Solution s = make_solver("nnls_paper").solve(p);
  EXPECT_EQ(s.message, "range gap 1.9e-01");  // |(1/2, 1/2)| / |(1, 3, 2)|
  EXPECT_LE((s.z - Vector{{1, 5}}).norm(), 1e-15);
}

// One body on the ground, z_u = -1: Eq. 10 as printed gives +1.
TEST(NnlsPaper, PutsTheHalfOutsideTheNorm) {
  const Solution s = make_solver("nnls_paper").solve(unit_mass(Matrix{{1}}, Vector{{0}}, Vector{{-1}}, 0));
  EXPECT_EQ(s.z[0], 0);
}

// The answer of each is 0. What tells it from z_u stands in one entry that is nothing to its row: a right angle's
// cosine, squared. Also as motions of a body, where dual_active_set has a fast path.
TEST(FaintEntries, AreNotTakenForNothing) {
  const double e = std::pow(std::cos(std::acos(0.)), 2);
  const auto row = [](double x, double y, double w) { return Eigen::RowVector3d(x, y, w); };
  for (const double faint : {e, 0x1p-104, 0x1p-250})
    for (const Index n : {3, 6})
      for (const auto& [first, second, equalities] :
           {std::tuple(row(0, 1, 0), row(faint, -1, 0), 0), std::tuple(row(0, 1, -1), row(faint, -2, 2), 0),
            std::tuple(row(0, 1, 0), row(faint, -1, 0), 2), std::tuple(row(0, 1, -1), row(faint, -2, 2), 1)}) {
        Matrix J = Matrix::Zero(2, n);
        J.topLeftCorner(1, 3) = first;
        J.bottomLeftCorner(1, 3) = second;
        Vector z_u = Vector::Zero(n);
        z_u[0] = -1;
        for (const char* solver : {"dual_active_set", "nnls", "cholesky"}) {
          const Solution s = make_solver(solver).solve(unit_mass(J, Vector::Zero(2), z_u, equalities));
          EXPECT_TRUE(s.status != Status::solved || s.z.norm() < 1e-10)
              << solver << ", " << n << ", " << faint << ", " << J << ": " << s.z.transpose();
        }
      }
}

}  // namespace
}  // namespace zwang
