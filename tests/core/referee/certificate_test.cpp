#include <zwang/core/referee/certificate.h>

#include <gtest/gtest.h>

#include <cmath>

#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

Problem dense_problem(const Matrix& J, const Vector& c, std::vector<RowKind> kind) {
  const Index n = J.cols();
  Problem p{.name = "test", .z_u = Vector::Zero(n), .J = J.sparseView(), .c = c, .kind = std::move(kind)};
  p.M.resize(n, n);
  p.M.setIdentity();
  p.key.resize(p.kind.size());
  return p;
}

Metrics claim_infeasible(const Problem& p, const Vector& u) {
  const Reference none{.feasible = false};
  return measure(p, {.status = Status::infeasible, .certificate = u}, &none, 1e-10);
}

// x >= 1 and -x + eps y >= 0: with u = (1, 1), h'u = 1 and |G'u| = eps, so every feasible |z| is at least 1 / eps.
Metrics wedge(double eps) {
  const Matrix J = (Matrix(2, 2) << 1, 0, -1, eps).finished();
  return claim_infeasible(dense_problem(J, Vec<double, 2>(1, 0), {RowKind::inequality, RowKind::inequality}),
                          Vec<double, 2>(1, 1));
}

TEST(Certificate, CountsFrom1e8MotionsOn) {
  EXPECT_EQ(wedge(0.9e-8).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(wedge(1.1e-8).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(wedge(0).verdict, Verdict::infeasible_proven);
}

TEST(Certificate, NeedsNonnegativeMultipliersAndAGain) {
  const Matrix J = (Matrix(2, 1) << 1, -1).finished();
  const Problem p = dense_problem(J, Vec<double, 2>(1, 0), {RowKind::inequality, RowKind::inequality});
  EXPECT_EQ(claim_infeasible(p, Vec<double, 2>(1, 1)).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(claim_infeasible(p, Vec<double, 2>(-1, -1)).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(claim_infeasible(p, Vec<double, 2>(1, 0)).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(claim_infeasible(p, {}).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(claim_infeasible(p, Vec<double, 2>(1, NAN)).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(claim_infeasible(p, Vector::Ones(3)).verdict, Verdict::infeasible_claimed);
}

TEST(Certificate, RoundedMultipliersAreMovedOntoTheNullSpace) {
  // Three rows that sum to zero with weights 1/3, 1/7, 1/11 after scaling; c is inconsistent by 2^-40.
  Matrix J(3, 2);
  J << 3, 0, 0, 7, -11, -11;
  const Problem p = dense_problem(J, Vec3(1, 1, -11.0 / 3 - 11.0 / 7 + std::ldexp(1.0, -40)),
                                  {RowKind::inequality, RowKind::inequality, RowKind::inequality});
  EXPECT_EQ(claim_infeasible(p, Vec3(1.0 / 3, 1.0 / 7, 1.0 / 11)).verdict, Verdict::infeasible_proven);
}

TEST(Certificate, NamesTheConflictingRowsLargestPartFirst) {
  Matrix J(4, 1);
  J << 1, 5, -1, 1;
  const Problem p = dense_problem(J, (Vector(4) << -1, 2, 1, -1).finished(), std::vector(4, RowKind::inequality));
  const Metrics m = claim_infeasible(p, (Vector(4) << 0, 0.2, 2, 1e-14).finished());
  EXPECT_EQ(m.conflicting, (std::vector<Index>{2, 1})) << "parts |u_i| |G_i| are 2 and 1";
}

TEST(Certificate, ARowOfZerosThatCannotHoldProvesIt) {
  const Problem p = dense_problem(Matrix::Zero(1, 2), Vector::Ones(1), {RowKind::inequality});
  EXPECT_EQ(claim_infeasible(p, Vector::Ones(1)).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(measure(p, {.status = Status::solved, .z = Vector::Zero(2)}, nullptr, 1e-10).verdict, Verdict::wrong);
}

// -2^-34 z = 2^-34 holds at z = -1. Beside it a row of zeros has nearly all of the weight.
TEST(Certificate, ARowWithHardlyAPartSaysHowLongAMotionIsToo) {
  const double tiny = std::ldexp(1.0, -34);
  const Problem p =
      dense_problem(Vec<double, 2>(-tiny, 0), Vec<double, 2>(tiny, 0), {RowKind::equality, RowKind::equality});
  const Vector u = Vector::Ones(2);
  EXPECT_EQ(claim_infeasible(p, u).verdict, Verdict::infeasible_claimed);
  EXPECT_EQ(measure(p, {.status = Status::infeasible, .certificate = u}, nullptr, 1e-10).verdict, Verdict::wrong);
}

// The same numbers whatever the rows, masses and lengths are measured in: powers of two change nothing at all.
TEST(Invariance, RowScalesAndUnitsChangeNoResidual) {
  Matrix J(3, 3);
  J << 1, 2, 0, 0, 1, -1, 3, 0, 1;
  const Problem p = dense_problem(J, Vec3(1, -1, 2), {RowKind::equality, RowKind::inequality, RowKind::inequality});
  const Solution s{.status = Status::solved, .z = Vec3(0.3, 0.4, 1), .lambda = Vec3(0.5, -0.25, 1)};
  const Reference truth{.z = Vec3(0.25, 0.5, 1)};
  const Metrics plain = measure(p, s, &truth, 1e-10), withheld = measure(p, s, nullptr, 1e-10);
  for (const int e : {-500, -40, 40, 500})
    for (const int mass : {-40, 0, 40})
      for (const int motion : {-400, 0, 400}) {
        Problem q = p;
        Solution t = s;
        Reference r = truth;
        const auto scale = [](auto& x, int k) { x *= std::ldexp(1.0, k); };
        scale(q.M, 2 * mass);
        scale(q.c, motion);
        scale(t.z, motion);
        scale(r.z, motion);
        scale(t.lambda, 2 * mass + motion);
        for (const int row : {0, 2}) {
          for (int j = 0; j < 3; ++j)
            if (J(row, j) != 0) q.J.coeffRef(row, j) = std::ldexp(J(row, j), e);
          q.c[row] = std::ldexp(q.c[row], e);
          t.lambda[row] = std::ldexp(t.lambda[row], -e);
        }
        if (!q.c.allFinite() || !t.lambda.allFinite()) continue;
        const Metrics m = measure(q, t, &r, 1e-10), w = measure(q, t, nullptr, 1e-10);
        EXPECT_DOUBLE_EQ(m.z_error, plain.z_error) << e << ' ' << mass << ' ' << motion;
        EXPECT_DOUBLE_EQ(m.primal, plain.primal);
        EXPECT_DOUBLE_EQ(m.dual, plain.dual);
        EXPECT_DOUBLE_EQ(m.stationarity, plain.stationarity);
        EXPECT_DOUBLE_EQ(m.complementarity, plain.complementarity);
        EXPECT_DOUBLE_EQ(m.gap, plain.gap);
        EXPECT_DOUBLE_EQ(m.natural, plain.natural);
        EXPECT_NEAR(w.z_bound, withheld.z_bound, 1e-12 * withheld.z_bound);
        EXPECT_EQ(w.verdict, withheld.verdict);
      }
}

// Rows 1e-10 apart: a z moved along the direction that neither row sees violates them by 1e-13 and is wrong by 1e-3.
TEST(NearParallel, TinyResidualsDoNotPassForARightZ) {
  const double eps = std::ldexp(1.0, -33);
  const Matrix J = (Matrix(2, 2) << 1, 0, 1, eps).finished();
  Problem p = dense_problem(J, Vec<double, 2>(1, 1 + eps), {RowKind::equality, RowKind::equality});
  const Vec<double, 2> lambda(0.5, 0.5);  // z* = (1, 1); z_u chosen so that lambda is its multiplier
  p.z_u = Vec<double, 2>(1, 1) - J.transpose() * lambda;
  Solution s{.status = Status::solved, .z = Vec<double, 2>(1, 1 + 1e-3), .lambda = lambda};
  s.lambda[1] += 1e-3 / eps;
  s.lambda[0] -= 1e-3 / eps;
  const Metrics wrong = measure(p, s, nullptr, 1e-10);
  EXPECT_LT(wrong.primal, 1e-12);
  EXPECT_LT(wrong.stationarity, 1e-8);
  EXPECT_EQ(wrong.verdict, Verdict::wrong);
  EXPECT_GE(wrong.z_bound, 1e-3 / std::sqrt(2.0));
  const Metrics right = measure(p, {.status = Status::solved, .z = Vec<double, 2>(1, 1)}, nullptr, 1e-10);
  EXPECT_EQ(right.verdict, Verdict::solved) << right.z_bound;
  EXPECT_LT(right.bound_sigma_min, 1e-9);
}

}  // namespace
}  // namespace zwang
