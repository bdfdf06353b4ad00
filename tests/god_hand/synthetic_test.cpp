#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <zwang/bench/collision/meshes.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/depth.h>
#include "tests/folders.h"

namespace zwang::god {
namespace {

using collision::Shape;

Object mesh_object(const collision::Mesh& mesh, const Vec3& at) {
  return {.name = "mesh", .mesh = std::make_shared<const collision::Tree>(mesh), .pose = {at, Mat3::Identity()}};
}

// A slab with its upper side at z = 0, as a mesh.
Surroundings slab() {
  return {.name = "slab", .objects = {mesh_object(meshes::plate({0.5, 0.5, 0.04}, 2000), {0, 0, -0.02})}};
}

// A loose box on a table, its top the focus.
Surroundings boxed() {
  Surroundings s = slab();
  s.name = "box";
  s.objects.push_back({.name = "box",
                       .pieces = {{Shape::rounded_box({0.06, 0.08, 0.05}, 1e-3), {}}},
                       .pose = {Vec3(0, 0, 0.025), Mat3::Identity()},
                       .mass = 0.2});
  s.focus = Vec3(0, 0, 0.05);
  return s;
}

double deepest(const Depth& depth, const Track& track, double time, double reach = 0) {
  const Target at = track.at(time);
  return depth.of(hand::forward_kinematics(at.palm, at.angles, track.model), balls(track.model), reach);
}

TEST(Depth, OfBallsInBoxesHullsMeshesAndSheets) {
  Surroundings s = boxed();
  const std::vector<Vec3> wedge{{1, 0, 0}, {1.1, 0, 0}, {1, 0.1, 0}, {1, 0, 0.1}};
  s.objects.push_back({.name = "wedge", .pieces = {{Shape::hull(wedge, 1e-3), {}}}});
  s.objects.push_back(mesh_object(meshes::sheet(0.2, 0.2, 200), {-1, 0, 0}));
  const Depth depth(s);
  EXPECT_NEAR(depth.distance(Vec3(0.1, 0.1, 0.03), 0, 1), 0.03, 1e-9);
  EXPECT_NEAR(depth.distance(Vec3(0.1, 0.1, -0.015), 0, 1), -0.015, 1e-9);
  EXPECT_NEAR(depth.distance(Vec3(0, 0, 0.04), 1, 1), -0.01, 1e-12);
  EXPECT_NEAR(depth.distance(Vec3(0.03 + 0.003, 0.04 + 0.004, 0), 1, 1),
              std::hypot(0.003 + 1e-3, 0.004 + 1e-3, 0.0) - 1e-3, 1e-3);
  EXPECT_NEAR(depth.distance(Vec3(1.01, 0.02, 0.02), 2, 1), -0.011, 1e-12);
  EXPECT_NEAR(depth.distance(Vec3(1.01, 0.02, -0.02), 2, 1), 0.019, 1e-12);
  for (const double z : {0.01, -0.01}) EXPECT_NEAR(depth.distance(Vec3(-1, 0, z), 3, 1), 0.01, 1e-12);
  EXPECT_EQ(depth.distance(Vec3(5, 5, 5), 0.25), 0.25);

  const hand::Poses hand = hand::forward_kinematics({Vec3(0.15, 0, 0.004), Mat3::Identity()}, {});
  // The thumb's root lies 10 mm under the palm's middle, 9 mm thick.
  EXPECT_NEAR(depth.of(hand, balls(hand::standard())), 0.015, 1e-9);
}

TEST(Synthetic, StartsClearStaysWithinLimitsAndTouches) {
  for (const Surroundings& about : {slab(), boxed()}) {
    const Depth depth(about);
    for (const auto& [name, line] : synthetic_motions()) {
      if (name == "lift" || name == "hold" || name == "push") continue;  // about a loose object
      if (name == "insert" || name == "unlock") continue;                // of tools
      const HandMotion motion = synthetic_motion(name, about);
      EXPECT_TRUE(motion.duration >= 2 && motion.duration <= 4) << name;
      EXPECT_EQ(motion.hands.size(), name == "two_hands" ? 2u : 1u);
      for (const Track& track : motion.hands) {
        EXPECT_LT(deepest(depth, track, 0, 0.02), -0.0099) << name;
        double most = -1, before = -1;
        for (const Track::Key& key : track.keys) {
          EXPECT_GT(key.time, before) << name;
          before = key.time;
          most = std::max(most, deepest(depth, track, key.time));
          for (int a = 0; a < hand::angles; ++a) {
            const double angle = key.target.angles[static_cast<std::size_t>(a)];
            EXPECT_TRUE(angle >= track.model.range(a).low && angle <= track.model.range(a).high)
                << name << " " << hand::angle_name(a) << " " << angle;
          }
        }
        // Of the jump through the slab there is nothing but its two ends.
        if (name != "teleport")
          EXPECT_GT(most, 0.01) << name << " on " << about.name;
        else
          EXPECT_LT(track.at(2).palm.position.z(), about.focus.z() - 0.18);
      }
    }
  }
}

TEST(Synthetic, PressGoesThirtyMillimetresDeep) {
  const Surroundings about = slab();
  const HandMotion motion = synthetic_motion("press", about);
  EXPECT_NEAR(motion.hands[0].at(1.5).palm.position.z() - hand::standard().palm_widths.z() / 2, -0.03, 1e-12);
}

TEST(Synthetic, SwipeRunsThroughAtFiveMetresASecond) {
  const Track track = synthetic_motion("swipe", slab()).hands[0];
  const auto palm = [&](double t) { return track.at(t).palm.position; };
  EXPECT_NEAR((palm(0.36) - palm(0.35)).norm() / 0.01, 5, 1e-9);
  EXPECT_GT(palm(0.3).z(), 0.2);
  EXPECT_LT(palm(0.6).z(), -0.2);
  EXPECT_EQ(palm(2), palm(0));
}

TEST(Synthetic, TeleportJumpsOverThirtyCentimetres) {
  const Track track = synthetic_motion("teleport", slab()).hands[0];
  const auto jump = [&](double t) {
    return (track.at(t + 1e-4).palm.position - track.at(t - 1e-3).palm.position).norm();
  };
  for (const double t : {0.501, 1.501, 2.201}) EXPECT_NEAR(jump(t), 0.3, 1e-3);
}

TEST(Synthetic, LostAndNaNAreHeldOverAndCounted) {
  const Track lost = synthetic_motion("lost", slab()).hands[0];
  EXPECT_EQ(lost.held_over, 60u);
  EXPECT_FALSE(lost.at(1.35).tracked);
  EXPECT_EQ(lost.at(1.49).palm.position, lost.at(1.2).palm.position);
  EXPECT_TRUE(lost.at(1.51).tracked);
  const HandMotion nan = synthetic_motion("nan", slab());
  EXPECT_EQ(nan.hands[0].held_over, 5u);
  EXPECT_EQ(nan.notes.size(), 1u);
  EXPECT_FALSE(nan.hands[0].at(1.002).tracked);
}

TEST(Synthetic, AWallThatStandsIsApproachedFromItsSide) {
  Surroundings wall = {.name = "wall",
                       .objects = {{.name = "wall", .pieces = {{Shape::rounded_box({1, 0.1, 1}, 1e-3), {}}}}}};
  wall.focus = Vec3(0.1, -0.05, 0.1);
  const HandMotion motion = synthetic_motion("press", wall);
  EXPECT_LT((motion.hands[0].at(1.5).palm.position - Vec3(0.1, -0.034, 0.1)).norm(), 1e-12);
  EXPECT_LT((motion.hands[0].at(1.5).palm.rotation.col(2) + Vec3::UnitY()).norm(), 1e-12);
}

TEST(Synthetic, UnknownNamesAreAnsweredWithTheNearest) {
  try {
    synthetic_motion("grap", slab());
    FAIL();
  } catch (const std::invalid_argument& bad) {
    EXPECT_STREQ(bad.what(), "no motion 'grap'; did you mean 'grasp'? (./zwang simulate --help lists all)");
  }
}

// A folder `grasp` where the program is called is not the motion grasp.
TEST(Synthetic, ANameIsANameWhateverLiesInTheFolder) {
  namespace fs = std::filesystem;
  const fs::path here = fs::current_path(), folder = own_path("names");
  fs::create_directories(folder / "grasp");
  fs::create_directories(folder / "takes");
  fs::current_path(folder);
  std::ofstream("fist").flush();
  std::ofstream("take1").flush();
  EXPECT_FALSE(names_file("grasp"));
  EXPECT_FALSE(names_file("fist"));
  EXPECT_FALSE(names_file("takes"));
  EXPECT_TRUE(names_file("take1"));
  EXPECT_TRUE(names_file("missing.json"));
  fs::current_path(here);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace zwang::god
