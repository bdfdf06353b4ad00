#include <zwang/solvers/joint_space/exchange_basis.h>

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <random>

namespace zwang {
namespace {

class ExchangeBasisTest : public testing::Test {
 protected:
  static constexpr Index padded = 32, length = 26, count = 40;

  ExchangeBasisTest() {
    columns.setZero(padded, count);
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    // Ten entries each, as a contact of a finger has them; from 30 on repeated.
    for (Index j = 0; j < 30; ++j) {
      columns.col(j).head(6) = Vector::NullaryExpr(6, [&] { return normal(random); });
      columns.col(j).segment(6 + 4 * (j % 5), 4) = Vector::NullaryExpr(4, [&] { return normal(random); });
      columns.col(j).normalize();
    }
    columns.rightCols(10) = columns.leftCols(10);
    rows.reset(length, count);
    rows.take(columns, 0, count);
    basis.reset(length, padded);
  }
  double append(Index j) {
    const double left = basis.split(rows, j);
    basis.find_remainder();
    basis.append();
    active.push_back(j);
    return left;
  }
  void drop(std::size_t at) {
    basis.drop(static_cast<Index>(at));
    active[at] = active.back();
    active.pop_back();
  }
  Matrix A() const { return columns(Eigen::all, active); }

  // dv - A'dmu = s and A dv = sigma.
  void expect_basis_of_active() {
    const Matrix A = this->A();
    const Index q = A.cols();
    ASSERT_EQ(basis.size(), q);
    Vector s = Vector::Zero(padded), sigma = Vector::Zero(padded), dv(padded), dmu(padded);
    s.head(length) = Vector::LinSpaced(length, -1, 1);
    sigma.head(q) = Vector::LinSpaced(q, -1, 2);
    basis.solve(s, sigma, dv, dmu);
    EXPECT_LE((dv - A * dmu.head(q) - s).norm(), 1e-11);
    EXPECT_LE((A.transpose() * dv - sigma.head(q)).norm(), 1e-11);
  }

  lanes::Columns columns;
  RowLanes rows;
  ExchangeBasis basis;
  std::vector<Index> active;
};

TEST_F(ExchangeBasisTest, SplitsARowIntoItsPartInTheSpanAndTheRest) {
  for (Index j = 0; j < 13; ++j) append(j);
  const Vector a = columns.col(17);
  const double left = basis.split(rows, 17);
  const Matrix A = this->A();
  const Vector r = A.householderQr().solve(a);
  EXPECT_NEAR(left, (a - A * r).norm(), 1e-14);
  EXPECT_LE((Eigen::Map<const Vector>(basis.r(), 13) - r).norm(), 1e-12);
  EXPECT_EQ(Eigen::Map<const Vector>(basis.r() + 13, padded - 13).norm(), 0);
  EXPECT_LE((Eigen::Map<const Vector>(basis.find_remainder(), padded) - (a - A * r)).norm(), 1e-14);
}

// A row that repeats one of the active rows is dependent to rounding after any history.
TEST_F(ExchangeBasisTest, HoldsTheInverseWhileRowsComeAndGo) {
  std::mt19937 random(2);
  double largest_rest = 0;
  int repeated = 0;
  for (int change = 0; change < 400; ++change) {
    if (active.size() == 24 || (active.size() > 1 && random() % 5 < 2)) {
      drop(random() % active.size());
    } else {
      Index j = 0;
      const auto is_active = [&](Index k) { return std::ranges::find(active, k) != active.end(); };
      do j = static_cast<Index>(random() % 30);
      while (is_active(j));
      const double left = append(j);
      if (left < 1e-2) drop(active.size() - 1);
      for (Index k = 0; k < 10; ++k)
        if (is_active(k)) {
          largest_rest = std::max(largest_rest, basis.split(rows, 30 + k));
          ++repeated;
        }
    }
    if (change % 20 == 0) expect_basis_of_active();
  }
  EXPECT_GT(repeated, 200);
  EXPECT_LE(largest_rest, 4e-15);
}

TEST_F(ExchangeBasisTest, MayFillTheWholeSpace) {
  for (Index j = 0; active.size() < static_cast<std::size_t>(length); ++j)
    if (basis.split(rows, j) > 1e-3) append(j);
  expect_basis_of_active();
  EXPECT_LE(basis.split(rows, 29), 1e-13);
  drop(3);
  expect_basis_of_active();
}

}  // namespace
}  // namespace zwang
