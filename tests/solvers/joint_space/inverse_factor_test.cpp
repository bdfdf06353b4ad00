#include <zwang/solvers/joint_space/inverse_factor.h>

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <random>

namespace zwang {
namespace {

class InverseFactorTest : public testing::Test {
 protected:
  static constexpr Index padded = 32, length = 26, room = 32;

  InverseFactorTest() {
    columns.setZero(padded, 24);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (Index j = 0; j < columns.cols(); ++j)
      columns.col(j).head(length) = Vector::NullaryExpr(length, [&] { return normal(random); }).normalized();
    factor.reset(padded, room);
  }
  void append(Index j) {
    factor.split(columns.col(j).data());
    factor.append();
    active.push_back(j);
  }
  void drop(Index at) {
    factor.drop(at);
    active.erase(active.begin() + at);
  }
  Matrix A() const { return columns(Eigen::all, active); }

  // R^-1 R^-T = (A'A)^-1, and Q spans A.
  void expect_factor_of_active() {
    const Matrix A = this->A();
    const Index q = A.cols();
    ASSERT_EQ(factor.size(), q);
    const Vector rhs = Vector::LinSpaced(q, -1, 2);
    Vector x = Vector::Zero(room + 8);
    x.head(q) = rhs;
    factor.solve_transposed(x);
    factor.solve(x);
    EXPECT_LE((A.transpose() * (A * x.head(q)) - rhs).norm(), 1e-12);
    const Vector w = Vector::LinSpaced(padded, -1, 1);
    Vector in_span = Vector::Zero(padded), d = Vector::Zero(room + 8);
    factor.project(w, d);
    factor.combine(d, in_span);
    EXPECT_LE((A.transpose() * (w - in_span)).norm(), 1e-13);
  }

  Matrix columns;
  InverseFactor factor;
  std::vector<Index> active;
};

TEST_F(InverseFactorTest, SplitsAColumnIntoItsPartInTheSpanAndTheRest) {
  for (Index j = 0; j < 10; ++j) append(j);
  const Vector a = columns.col(12);
  const double left = factor.split(a.data());
  const Matrix A = this->A();
  const Vector r = A.householderQr().solve(a);
  EXPECT_NEAR(left, (a - A * r).norm(), 1e-14);
  EXPECT_LE((factor.r().head(10) - r).norm(), 1e-13);
  EXPECT_LE((Eigen::Map<const Vector>(factor.remainder(), padded) - (a - A * r)).norm(), 1e-14);
}

TEST_F(InverseFactorTest, HoldsTheFactorWhileColumnsComeAndGo) {
  std::mt19937 random(2);
  for (Index j = 0; j < 20; ++j) append(j);
  expect_factor_of_active();
  for (int change = 0; change < 200; ++change) {
    if (active.size() == 24 || (active.size() > 1 && random() % 2)) {
      drop(static_cast<Index>(random() % active.size()));
    } else {
      Index j = 0;
      while (std::ranges::find(active, j) != active.end()) ++j;
      append(j);
    }
    if (change % 20 == 0) expect_factor_of_active();
  }
  expect_factor_of_active();
}

// A Q is carried through a drop by the same rotations.
TEST_F(InverseFactorTest, RowsFollowADrop) {
  for (Index j = 0; j < 12; ++j) append(j);
  const Matrix rows = Matrix::Random(16, padded);
  const auto product = [&](Index j) -> Vector { return rows * Eigen::Map<const Vector>(factor.column(j), padded); };
  lanes::Columns AQ(16, room);
  for (Index j = 0; j < 12; ++j) AQ.col(j) = product(j);
  drop(3);
  factor.follow(AQ, 16);
  for (Index j = 0; j < 11; ++j) EXPECT_LE((AQ.col(j) - product(j)).norm(), 1e-13) << j;
}

TEST_F(InverseFactorTest, ARepeatedColumnLeavesNothing) {
  for (Index j = 0; j < 10; ++j) append(j);
  EXPECT_LE(factor.split(columns.col(4).data()), 1e-15);
}

}  // namespace
}  // namespace zwang
