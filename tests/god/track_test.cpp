#include <gtest/gtest.h>

#include "experiments/god/motion.h"

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
  EXPECT_TRUE(track.at(1.5).tracked);
  EXPECT_FALSE(track.at(0.5).tracked);
  EXPECT_FALSE(track.at(2).tracked);
  EXPECT_EQ(track.at(2).palm.position.x(), 0.1);
}

}  // namespace
}  // namespace zwang::god
