#include <zwang/solvers/factor/inverse_factor.h>

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

  // dv - A'dmu = s and A dv = sigma.
  void expect_factor_of_active() {
    const Matrix A = this->A();
    const Index q = A.cols();
    ASSERT_EQ(factor.size(), q);
    Vector s = Vector::Zero(padded), sigma = Vector::Zero(room), dv(padded), dmu(room);
    s.head(length) = Vector::LinSpaced(length, -1, 1);
    sigma.head(q) = Vector::LinSpaced(q, -1, 2);
    factor.solve(s, sigma, dv, dmu);
    EXPECT_LE((dv - A * dmu.head(q) - s).norm(), 1e-12);
    EXPECT_LE((A.transpose() * dv - sigma.head(q)).norm(), 1e-12);
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

TEST_F(InverseFactorTest, ARepeatedColumnLeavesNothing) {
  for (Index j = 0; j < 10; ++j) append(j);
  EXPECT_LE(factor.split(columns.col(4).data()), 1e-15);
}

// 26 columns of 26 entries; then nothing is left of any.
TEST_F(InverseFactorTest, MayFillTheWholeSpace) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  columns.setZero(padded, length + 1);
  for (Index j = 0; j <= length; ++j)
    columns.col(j).head(length) = Vector::NullaryExpr(length, [&] { return normal(random); }).normalized();
  for (Index j = 0; j < length; ++j) append(j);
  expect_factor_of_active();
  EXPECT_LE(factor.split(columns.col(length).data()), 1e-13);
  drop(3);
  expect_factor_of_active();
}

}  // namespace
}  // namespace zwang
