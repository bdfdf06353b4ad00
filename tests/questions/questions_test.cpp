#include <gtest/gtest.h>

#include <cstdlib>

#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {
namespace {

// The problems of a simulated grasp go through the flow of the suites: timed, and verified by the referee.
TEST(Questions, GrowthTimesAndVerifiesTheProblemsOfAGrasp) {
  const Findings found = growth_with_contacts({.seconds = 1.6});
  ASSERT_EQ(found.columns.size(), 4u);
  ASSERT_GE(found.rows.size(), 5u);
  ASSERT_EQ(found.charts.size(), 1u);
  ASSERT_EQ(found.charts[0].points.size(), found.rows.size());
  double before = 0;
  for (std::size_t k = 0; k < found.rows.size(); ++k) {
    EXPECT_TRUE(found.rows[k][3].ends_with(" solved") && found.rows[k][3].find(',') == std::string::npos)
        << found.rows[k][3];
    EXPECT_GT(found.charts[0].points[k].x, before);
    EXPECT_GT(found.charts[0].points[k].y, 0);
    before = found.charts[0].points[k].x;
  }
}

TEST(Questions, AnInterruptedOneSaysSo) {
  const std::atomic<bool> now = true;
  EXPECT_THROW(growth_with_contacts({.interrupted = &now}), Interrupted);
}

// As printed the share of a step that is free counts twice: the gap never falls below half of what is left.
TEST(Questions, ThePrintedStepStopsShortOfTheWall) {
  const Findings found = printed_step({});
  ASSERT_FALSE(found.rows.empty());
  const double once = std::atof(found.rows.back()[1].c_str()), twice = std::atof(found.rows.back()[2].c_str());
  EXPECT_GT(once, 0);
  EXPECT_LT(once, 0.11);
  EXPECT_GT(twice, 10 * once);
}

}  // namespace
}  // namespace zwang::questions
