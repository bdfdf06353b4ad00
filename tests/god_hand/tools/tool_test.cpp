#include <zwang/experiments/god_hand/tools/tool.h>

#include <filesystem>
#include <fstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/experiments/god_hand/tools/tool.h>
#include "tests/folders.h"
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

struct Extremes {
  double lowest = 1, highest = -1, gap = 1, joints = 0, behind = 0;
};

// The tip of a tool, `tip` along the y of its first body, over a whole motion.
Extremes play(const std::string& scene, const std::string& name, const std::string& motion_name, double tip,
              double after = 0) {
  const Surroundings s = make_surroundings(scene, "");
  const HandMotion motion = synthetic_motion(motion_name, s);
  const Tool tool = make_tool(name);
  Play play(s, motion, unverified(), &tool);
  Extremes e;
  for (long k = 0; k < static_cast<long>(1e3 * motion.duration); ++k) {
    const Frame& f = play.step(k);
    e.gap = std::min(e.gap, f.gap);
    e.joints = std::max(e.joints, f.separation);
    const double z = (f.god[0] * Vec3(0, tip, 0)).z();
    e.lowest = std::min(e.lowest, z);
    if (f.time > after) e.highest = std::max(e.highest, z);
    e.behind = std::max(e.behind, f.distance);
  }
  return e;
}

// 0.3 mm of clearance; the target is 1.5 mm and 2 degrees off.
TEST(Tool, APegFindsItsHole) {
  const Extremes e = play("hole", "peg", "insert", 0.04);
  EXPECT_GT(e.gap, 0);
  EXPECT_LT(e.lowest, -0.03);
  EXPECT_GT(e.behind, 1e-3);
}

// Turned behind the plate, a key does not come out where its target does; turned back, it does.
TEST(Tool, AKeyHoldsWhereItIsTurned) {
  const Surroundings s = make_surroundings("lock", "");
  const HandMotion motion = synthetic_motion("unlock", s);
  const Tool tool = make_tool("key");
  Play play(s, motion, unverified(), &tool);
  double pulled = 1, target = -1, last = -1;
  for (long k = 0; k < static_cast<long>(1e3 * motion.duration); ++k) {
    const Frame& f = play.step(k);
    ASSERT_GT(f.gap, 0) << k;
    ASSERT_LE(f.separation, 1e-12) << k;
    if (k == 2500) pulled = f.god[1].position.z(), target = f.target[1].position.z();
    last = f.god[0].position.z();
  }
  EXPECT_LT(pulled, -0.008);  // the bit, below the plate
  EXPECT_GT(target, 0);
  EXPECT_GT(last, 0.049);
}

TEST(Tool, AGripperClosesAsFarAsThereIsRoom) {
  const Tool tool = make_tool("gripper");
  Target open{.palm = posed(0, 0, 0.2)}, shut = open;
  shut.angles[4] = 1.1;
  const auto between = [](std::span<const Pose<double>> p) {
    return (p[1] * Vec3(0, 0.03, 0) - p[2] * Vec3(0, 0.03, 0)).norm();
  };
  EXPECT_GT(between(tool.poses(open)), 0.045);
  EXPECT_LT(between(tool.poses(shut)), 0.012);  // in each other
  HandMotion motion{.name = "close", .hands = {Track{.model = hand::standard()}}, .duration = 1};
  append(motion.hands[0], {0, open});
  append(motion.hands[0], {1, shut});
  motion.hands[0].patience = 2;
  Play play({.name = "nothing"}, motion, unverified(), &tool);
  for (long k = 0; k <= 1000; ++k) {
    const Frame& f = play.step(k);
    ASSERT_GT(f.gap, 0) << k;
    ASSERT_LE(f.separation, 1e-12) << k;
    if (k == 1000) {
      EXPECT_NEAR(between(f.god), 0.0122, 2e-3);
    }
  }
}

TEST(Tool, FollowsAPathFromATable) {
  const auto file = own_path("path.csv");
  std::ofstream(file) << "time,x,y,z,qw,qx,qy,qz\n5,0,0,0.1,1,0,0,0\n6,0.2,0,0.1,2,0,0,0\n";
  const Tool tool = make_tool("sphere");
  const std::optional<HandMotion> motion = read_path(file, tool);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->duration, 1);
  EXPECT_NEAR(motion->hands[0].at(0.5).palm.position.x(), 0.1, 1e-12);
  Play play({.name = "nothing"}, *motion, unverified(), &tool);
  for (long k = 0; k < 500; ++k) play.step(k);
  EXPECT_NEAR(play.step(500).god[0].position.x(), 0.1, 1e-9);
  std::ofstream(file) << "time,x,y,z,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n";
  EXPECT_THROW(read_path(file, tool), BadFile);
  std::ofstream(file) << "time,palm_x\n1,0\n2,0\n";
  EXPECT_FALSE(read_path(file, tool));
  std::filesystem::remove(file);
  EXPECT_THROW(make_tool("pig"), std::invalid_argument);
}

}  // namespace
}  // namespace zwang::god
