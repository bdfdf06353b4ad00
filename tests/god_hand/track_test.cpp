#include <gtest/gtest.h>

#include <cmath>

#include <zwang/experiments/god_hand/motion/hand_motion.h>

namespace zwang::god {
namespace {

Track two_keys(double pause) {
  Track track;
  track.keys = {{1, {}}, {1 + pause, {}}};
  track.keys[1].target.palm.position = Vec3(0.1, 0, 0);
  track.keys[1].target.angles[3] = 0.8;
  return track;
}

TEST(Track, GoesStraightBetweenKeys) {
  const Target half = two_keys(0.02).at(1.01);
  EXPECT_TRUE(half.tracked);
  EXPECT_NEAR(half.palm.position.x(), 0.05, 1e-15);
  EXPECT_NEAR(half.angles[3], 0.4, 1e-15);
}

TEST(Track, HoldsTheLastPoseWhereTrackingIsLost) {
  const Track track = two_keys(0.5);
  EXPECT_EQ(track.at(1.3).palm.position.x(), 0);
  EXPECT_FALSE(track.at(1.3).tracked);
  EXPECT_FALSE(track.at(1.01).tracked);
  EXPECT_TRUE(track.at(1.5).tracked);
  EXPECT_FALSE(track.at(0.5).tracked);
  EXPECT_FALSE(track.at(2).tracked);
  EXPECT_EQ(track.at(2).palm.position.x(), 0.1);
}

TEST(Track, HoldsNaNOverCountsItAndGoesOnAtTheNextTrackedKey) {
  Track track;
  append(track, {0, {.tracked = false}});
  for (int k = 0; k < 4; ++k) {
    Target target;
    target.palm.position = Vec3(0.1 * k, 0, 0);
    if (k == 2) target.angles[5] = std::nan("");
    append(track, {1 + 0.01 * k, target});
  }
  EXPECT_EQ(track.held_over, 2u);
  ASSERT_EQ(track.keys.size(), 4u);
  for (const double time : {1.015, 1.02, 1.025}) {
    EXPECT_FALSE(track.at(time).tracked);
    EXPECT_EQ(track.at(time).palm.position.x(), 0.1);
    EXPECT_EQ(track.at(time).angles[5], 0);
  }
  EXPECT_TRUE(track.at(1.03).tracked);
  EXPECT_NEAR(track.at(1.03).palm.position.x(), 0.3, 1e-15);
}

}  // namespace
}  // namespace zwang::god
