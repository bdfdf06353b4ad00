#include <zwang/core/referee/measure.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

Problem dense_problem(const Matrix& M, const Vector& z_u, const Matrix& J, const Vector& c, std::vector<RowKind> kind) {
  Problem p{.name = "test", .M = M.sparseView(), .z_u = z_u, .J = J.sparseView(), .c = c, .kind = std::move(kind)};
  p.key.resize(p.kind.size());
  return p;
}

// A point of 4 kg falls on a floor: z_u = -10 along z, the floor holds it. |z_u|_M = 20 = s, |G| = 1/2.
Problem floor_problem() {
  return dense_problem(4 * Matrix::Identity(3, 3), Vec3(0, 0, -10), Vec3(0, 0, 1).transpose(), Vector::Zero(1),
                       {RowKind::inequality});
}

Solution answer(Vector z, Vector lambda) {
  return {.status = Status::solved, .z = std::move(z), .lambda = std::move(lambda)};
}

Reference at_rest() { return {.z = Vec3::Zero(), .lambda = Vector::Constant(1, 40), .method = "closed form"}; }

TEST(Measure, ResidualsMatchHandComputedValues) {
  const Reference truth = at_rest();
  const Metrics m = measure(floor_problem(), answer(Vec3(0, 0, -0.5), Vector::Constant(1, 38)), &truth, 1e-10);
  EXPECT_DOUBLE_EQ(m.scale, 20);
  EXPECT_DOUBLE_EQ(m.z_error, 1.0 / 20);  // |(0, 0, -0.5)|_M = 1
  EXPECT_DOUBLE_EQ(m.primal, 1.0 / 20);   // 0.5 / |G| = 1
  EXPECT_DOUBLE_EQ(m.dual, 0);
  EXPECT_NEAR(m.stationarity, 0, 1e-17);  // M d = 4 * 9.5 = 38
  EXPECT_DOUBLE_EQ(m.complementarity, 38 * 0.5 / 400);
  EXPECT_DOUBLE_EQ(m.gap, -38 * 0.5 / 400);  // an infeasible z may have a negative gap
  EXPECT_DOUBLE_EQ(m.natural, 1.0 / 20);     // min(38 / 2, -1)
  EXPECT_EQ(m.worst_row, 0);
  EXPECT_EQ(m.verdict, Verdict::wrong);
}

TEST(Measure, NegativeMultiplierIsDualViolation) {
  const Reference truth = at_rest();
  const Metrics m = measure(floor_problem(), answer(Vec3::Zero(), Vector::Constant(1, -3)), &truth, 1e-10);
  EXPECT_DOUBLE_EQ(m.dual, 1.5 / 20);
  EXPECT_DOUBLE_EQ(m.stationarity, 43.0 / 2 / 20);
  EXPECT_EQ(m.verdict, Verdict::solved) << "z alone decides";
}

TEST(Measure, WithoutMultipliersTheirResidualsAreUnknown) {
  const Reference truth = at_rest();
  const Metrics m = measure(floor_problem(), answer(Vec3::Zero(), {}), &truth, 1e-10);
  EXPECT_EQ(m.primal, 0);
  for (const double x : {m.dual, m.stationarity, m.complementarity, m.gap, m.natural}) EXPECT_TRUE(std::isnan(x));
  EXPECT_EQ(m.verdict, Verdict::solved);
}

TEST(Verdict, FollowsTheErrorAndTheToleranceAskedFor) {
  const Reference truth = at_rest();
  const auto verdict = [&](double error, double tolerance) {
    return measure(floor_problem(), answer(Vec3(0, 0, 10 * error), Vector::Constant(1, 40)), &truth, tolerance).verdict;
  };
  EXPECT_EQ(verdict(0.9e-12, 1e-14), Verdict::solved);
  EXPECT_EQ(verdict(1.1e-12, 1e-14), Verdict::near);
  EXPECT_EQ(verdict(0.9e-9, 1e-14), Verdict::near);
  EXPECT_EQ(verdict(1.1e-9, 1e-14), Verdict::wrong);
  EXPECT_EQ(verdict(0.9e-5, 1e-6), Verdict::solved);
  EXPECT_EQ(verdict(1.1e-5, 1e-6), Verdict::near);
  EXPECT_EQ(verdict(1.1e-2, 1e-6), Verdict::wrong);
}

TEST(Verdict, StatusWithoutAnAnswer) {
  const auto verdict = [](Status status, Vector z) {
    return measure(floor_problem(), {.status = status, .z = std::move(z)}, nullptr, 1e-10).verdict;
  };
  EXPECT_EQ(verdict(Status::unsolved, {}), Verdict::no_answer);
  EXPECT_EQ(verdict(Status::numerical_failure, Vec3::Zero()), Verdict::no_answer);
  EXPECT_EQ(verdict(Status::crashed, {}), Verdict::crashed);
  EXPECT_EQ(verdict(Status::unsupported, {}), Verdict::unsupported);
  EXPECT_EQ(verdict(Status::bad_input, {}), Verdict::bad_input);
  EXPECT_EQ(verdict(Status::time_limit, {}), Verdict::timeout);
}

TEST(Verdict, StoppedSolversAreJudgedByTheirZ) {
  const Reference truth = at_rest();
  const auto verdict = [&](Status status, Vec3 z) {
    return measure(floor_problem(), {.status = status, .z = z}, &truth, 1e-10).verdict;
  };
  EXPECT_EQ(verdict(Status::iteration_limit, Vec3::Zero()), Verdict::solved);
  EXPECT_EQ(verdict(Status::iteration_limit, Vec3(1, 0, 0)), Verdict::wrong);
  EXPECT_EQ(verdict(Status::solved_ill_conditioned, Vec3::Zero()), Verdict::solved);
  EXPECT_EQ(verdict(Status::time_limit, Vec3::Zero()), Verdict::solved);
  EXPECT_EQ(verdict(Status::time_limit, Vec3(1, 0, 0)), Verdict::timeout);
}

TEST(Verdict, BrokenAnswersAreWrong) {
  const Reference truth = at_rest();
  for (const Reference* reference : {&truth, static_cast<const Reference*>(nullptr)}) {
    EXPECT_EQ(measure(floor_problem(), answer(Vec3(0, nan_value, 0), {}), reference, 1e-10).verdict, Verdict::wrong);
    EXPECT_EQ(measure(floor_problem(), answer(Vector::Zero(2), {}), reference, 1e-10).verdict, Verdict::wrong);
    EXPECT_EQ(measure(floor_problem(), answer({}, {}), reference, 1e-10).verdict, Verdict::wrong);
    EXPECT_EQ(measure(floor_problem(), answer(Vec3(0, 0, 1e300), {}), reference, 1e-10).verdict, Verdict::wrong);
  }
}

// Points in a row, each held to the next by a joint or pushed by it along one of two axes with friction: one island of
// 2,000 unknowns, beyond what bounds are computed for. A point that violates a row is far from every solution all the
// same.
TEST(Verdict, WhoViolatesRowsIsWrongAtAnySize) {
  constexpr Index points = 1000;
  for (const Law law : {Law::frictionless, Law::convex, Law::coulomb}) {
    std::vector<Eigen::Triplet<double>> J, M;
    Problem p{.name = "row", .z_u = Vector::Zero(2 * points), .law = law};
    const auto row = [&](RowKind kind, Index axis, Index point) {
      const auto i = static_cast<Index>(p.kind.size());
      J.emplace_back(i, 2 * point + axis, -1);
      if (point > 0) J.emplace_back(i, 2 * point - 2 + axis, 1);
      p.kind.push_back(kind);
      p.key.push_back({static_cast<std::uint64_t>(i) + 1, 0});
    };
    for (Index k = 0; k < 2 * points; ++k) M.emplace_back(k, k, 1);
    for (Index k = 0; k < points; ++k) {
      row(law == Law::frictionless ? RowKind::equality : RowKind::inequality, 0, k);
      row(law == Law::frictionless ? RowKind::equality : RowKind::tangent, 1, k);
    }
    p.M.resize(2 * points, 2 * points);
    p.M.setFromTriplets(M.begin(), M.end());
    p.J.resize(2 * points, 2 * points);
    p.J.setFromTriplets(J.begin(), J.end());
    p.c.setZero(2 * points);
    p.mu.setZero(law == Law::frictionless ? 0 : 2 * points);
    for (Index i = 0; i < p.mu.size(); i += 2) p.mu[i] = 0.5;
    p.z_u[0] = 1;
    const Metrics free = measure(p, answer(p.z_u, {}), nullptr, 1e-10);
    EXPECT_EQ(free.verdict, Verdict::wrong) << to_string(law);
    EXPECT_GE(free.primal, 0.7);
    Vector z = Vector::Zero(2 * points);
    EXPECT_NE(measure(p, answer(z, {}), nullptr, 1e-10).verdict, Verdict::wrong) << "it meets all rows";
    z[0] = -1e-3;  // and opens the first contact, closes the second
    EXPECT_EQ(measure(p, answer(z, {}), nullptr, 1e-10).verdict, Verdict::wrong) << to_string(law);
  }
}

TEST(Verdict, InfeasibleSaidOfAFeasibleProblemIsWrong) {
  const Reference truth = at_rest();
  const Solution claim{.status = Status::infeasible, .certificate = Vector::Ones(1)};
  EXPECT_EQ(measure(floor_problem(), claim, &truth, 1e-10).verdict, Verdict::wrong);
  EXPECT_EQ(measure(floor_problem(), claim, nullptr, 1e-10).verdict, Verdict::wrong)
      << "the referee finds a feasible z";
}

TEST(Verdict, AnyZOfAnInfeasibleProblemIsWrong) {
  const Reference none{.feasible = false};
  EXPECT_EQ(measure(floor_problem(), answer(Vec3::Zero(), {}), &none, 1e-10).verdict, Verdict::wrong);
}

TEST(Verdict, SeverityIsATotalOrder) {
  std::set<int> places;
  for (int k = 0; k <= static_cast<int>(last_verdict); ++k) places.insert(severity(static_cast<Verdict>(k)));
  EXPECT_EQ(places.size(), static_cast<std::size_t>(last_verdict) + 1);
  EXPECT_EQ(worse(Verdict::consistent, Verdict::wrong), Verdict::wrong);
  EXPECT_EQ(worse(Verdict::solved, Verdict::rows_off), Verdict::rows_off);
}

}  // namespace
}  // namespace zwang
