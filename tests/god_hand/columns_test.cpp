#include <zwang/experiments/god_hand/measure/columns.h>

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include <zwang/experiments/god_hand/measure/step_cost.h>

namespace zwang::god {
namespace {

TEST(Totals, AreLeastMostAndSumOfEachColumnWithoutNaN) {
  std::vector<Frame> frames(3);
  frames[0].gap = 2e-4, frames[1].gap = std::numeric_limits<double>::quiet_NaN(), frames[2].gap = 0.5;
  frames[0].held = frames[2].held = true;
  frames[1].raw = 7, frames[2].raw = 3;
  Totals totals;
  for (const Frame& frame : frames) totals.add(frame);
  EXPECT_EQ(totals.frames(), 3);
  EXPECT_EQ(totals.touching(), 1);
  EXPECT_EQ(totals.of("gap").least, 2e-4);
  EXPECT_EQ(totals.of("gap").most, 0.5);
  EXPECT_EQ(totals.of("gap").sum, 2e-4 + 0.5);
  EXPECT_EQ(totals.of("held").sum, 2);
  EXPECT_EQ(totals.of("raw").most, 7);
  EXPECT_EQ(totals.of("raw").sum, 10);
  EXPECT_THROW(totals.of("no such"), std::logic_error);
  EXPECT_TRUE(std::isnan(Totals().of("gap").least));
}

TEST(StepCost, OfTheLastStepsAndOfAll) {
  StepCost last(2), all;
  for (const double solve : {8e-3, 1e-3, 3e-3}) {
    last.add({.solve = solve});
    all.add({.solve = solve});
  }
  EXPECT_EQ(last.quantile(0), 1e-3);
  EXPECT_EQ(last.quantile(1), 3e-3);
  EXPECT_EQ(all.quantile(0.5), 3e-3);
  EXPECT_EQ(all.quantile(1), 8e-3);
  EXPECT_NEAR(last.seconds(), 12e-3, 1e-15);
  EXPECT_EQ(StepCost(2).quantile(0.5), 0);
}

}  // namespace
}  // namespace zwang::god
