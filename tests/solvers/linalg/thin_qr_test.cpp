#include <zwang/solvers/linalg/thin_qr.h>

#include <gtest/gtest.h>

#include <zwang/solvers/active_set/lawson_hanson.h>

namespace zwang {
namespace {

Matrix pseudo_random(Index rows, Index columns, unsigned seed) {
  std::srand(seed);
  return Matrix::Random(rows, columns);
}

TEST(ThinQr, StaysOrthogonalWhileColumnsComeAndGo) {
  const Matrix A = pseudo_random(8, 12, 1);
  ThinQr qr;
  qr.reset(8, 8);
  std::vector<Index> held;
  for (Index j = 0; j < 12; ++j) {
    if (held.size() == 6) {
      qr.drop(2);
      held.erase(held.begin() + 2);
    }
    ASSERT_GT(qr.append(A.col(j), 1e-12), 1e-12);
    held.push_back(j);
  }
  const Index k = qr.size();
  EXPECT_LE((qr.Q().transpose() * qr.Q() - Matrix::Identity(k, k)).norm(), 1e-14);
  // A x = Q R x = Q t, so R^-1 Q' A is the identity.
  Matrix x = qr.Q().transpose() * A(Eigen::all, held);
  qr.solve(x);
  EXPECT_LE((x - Matrix::Identity(k, k)).norm(), 1e-12);
}

TEST(ThinQr, TellsHowDependentARejectedColumnIs) {
  ThinQr qr;
  qr.reset(3, 3);
  qr.append(Vec3(1, 0, 0), 1e-12);
  EXPECT_EQ(qr.append(Vec3(2, 0, 0), 1e-12), 0);
  EXPECT_NEAR(qr.append(Vec3(1, 1e-13, 0), 1e-12), 1e-13, 1e-20);
  EXPECT_EQ(qr.size(), 1);
}

TEST(ThinQr, TellsASharePastZerosAsASplitDoes) {
  const Matrix A = pseudo_random(40, 20, 3);
  ThinQr qr;
  qr.reset(40, 20);
  for (Index j = 0; j < 20; ++j) qr.append(A.col(j), 1e-12);
  EXPECT_LE(qr.share(A.col(7)), 1e-14);
  EXPECT_EQ(qr.share(Vector::Zero(40)), 0);
  for (Index begin = 0; begin < 40; begin += 8) {
    Vector a = Vector::Zero(40);
    a.segment<8>(begin) = A.col(0).segment<8>(begin);
    const double share = qr.share(a);
    EXPECT_NEAR(share, qr.split(a), 1e-15);
    EXPECT_LE((qr.Q().transpose() * qr.remainder()).norm(), 1e-15);
  }
}

// A free column takes the sign it needs; a bounded one does not.
TEST(LawsonHanson, HonoursFreeColumns) {
  const Matrix E = Matrix::Identity(3, 3);
  const Vector f{{-1, -2, 3}};
  const std::vector<char> free = {1, 0, 0};
  LawsonHanson solver;
  int iterations = 0;
  EXPECT_EQ(solver.solve(E, f, free, {}, iterations, {.iterations = 100}), Status::solved);
  EXPECT_EQ(solver.x(), (Vector{{-1, 0, 3}}));
  EXPECT_EQ(solver.residual(), (Vector{{0, -2, 0}}));
}

TEST(LawsonHanson, MeetsTheKktConditionsFromAnyWarmStart) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Matrix E = pseudo_random(6, 10, seed);
    const Vector f = pseudo_random(6, 1, seed + 1000);
    const std::vector<char> free(10, 0);
    const std::vector<Index> warm = {9, 3, 5, 1};
    LawsonHanson cold, warmed;
    int iterations = 0;
    ASSERT_EQ(cold.solve(E, f, free, {}, iterations, {.iterations = 100}), Status::solved);
    ASSERT_EQ(warmed.solve(E, f, free, warm, iterations = 0, {.iterations = 100}), Status::solved);
    const Vector gradient = E.transpose() * cold.residual();
    EXPECT_GE(cold.x().minCoeff(), 0);
    EXPECT_LE(gradient.maxCoeff(), 1e-14);
    EXPECT_LE(cold.x().cwiseProduct(gradient).norm(), 1e-13);
    EXPECT_LE((cold.residual() - warmed.residual()).norm(), 1e-13);
  }
}

TEST(LawsonHanson, StopsAtItsIterationLimit) {
  const Matrix E = Matrix::Identity(3, 3);
  const std::vector<char> free(3, 0);
  LawsonHanson solver;
  int iterations = 0;
  EXPECT_EQ(solver.solve(E, Vec3(1, 2, 3), free, {}, iterations, {.iterations = 1}), Status::iteration_limit);
  EXPECT_EQ(iterations, 1);
  EXPECT_EQ(solver.x(), Vec3(0, 0, 3));
}

}  // namespace
}  // namespace zwang
