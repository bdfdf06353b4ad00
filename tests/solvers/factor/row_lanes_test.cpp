#include <zwang/solvers/factor/row_lanes.h>

#include <gtest/gtest.h>

#include <limits>

namespace zwang {
namespace {

// Rows of 11 entries of which every third is zero in the first ten rows, and all but two in the others.
lanes::Columns rows_of(Index count) {
  lanes::Columns At = lanes::Columns::Zero(16, count);
  for (Index i = 0; i < count; ++i)
    for (Index k = 0; k < 11; ++k)
      if (i < 10 ? (i + k) % 3 > 0 : k == 2 || k == 9) At(k, i) = static_cast<double>(1 + i * i - 3 * k);
  return At;
}

TEST(RowLanesTest, MultipliesRowsThatCameInSeveralTimes) {
  const lanes::Columns At = rows_of(29);
  RowLanes rows;
  rows.reset(11, 29);
  const Vector x = Vector::LinSpaced(16, -1, 4);
  Index known = 0;
  for (const Index count : {1, 8, 13, 29}) {
    rows.take(At, known, count);
    known = count;
    Vector y = Vector::Constant(32, 5);
    rows.accumulate(-2, x.data(), y.data());
    const Vector expected = Vector::Constant(count, 5) - 2 * At.leftCols(count).transpose() * x;
    EXPECT_LE((y.head(count) - expected).norm(), 1e-10) << count;
    // Rows up to whole lanes are zero, and nothing is written behind them.
    EXPECT_EQ(y.tail(32 - count), Vector::Constant(32 - count, 5)) << count;
  }
}

TEST(RowLanesTest, KeepsOnlyColumnsThatARowOfEightMeets) {
  const lanes::Columns At = rows_of(29);
  RowLanes rows;
  rows.reset(11, 29);
  rows.take(At, 0, 29);
  Vector x = Vector::Constant(16, std::numeric_limits<double>::quiet_NaN()), y = Vector::Zero(32);
  x[2] = 3;
  x[9] = 5;
  rows.accumulate(1, x.data(), y.data());
  EXPECT_TRUE(y.head(16).array().isNaN().all());
  for (Index i = 16; i < 29; ++i) EXPECT_EQ(y[i], 3 * At(2, i) + 5 * At(9, i)) << i;
}

}  // namespace
}  // namespace zwang
