#include <gtest/gtest.h>

#include <zwang/bench/collision/meshes.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/depth.h>
#include "tests/god_hand/leap_document.h"
#include "tests/recorded_data.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

Surroundings slab(const Vec3& widths) {
  Surroundings s = {.name = "slab"};
  s.objects.push_back({.name = "slab",
                       .mesh = std::make_shared<const collision::Tree>(meshes::plate(widths, 2000)),
                       .pose = {Vec3(0.3, 0.1, 0.5 - widths.z() / 2), Mat3::Identity()}});
  s.focus = Vec3(0.3, 0.1, 0.5);
  return s;
}

void expect_placed(const std::string& what, HandMotion motion, const Surroundings& about) {
  const double duration = motion.duration;
  const Placement placement = place(motion, about);
  const Depth depth(about);
  std::printf("%s: %.0f %% inside, %.1f mm deep\n", what.c_str(), 100 * placement.inside, 1e3 * placement.depth);
  EXPECT_GE(placement.inside, 1.0 / 3) << what;
  EXPECT_GE(placement.depth, 0.010) << what;
  EXPECT_TRUE(motion.duration == duration || std::abs(motion.duration - duration - 0.5) < 1e-12);
  for (const Track& track : motion.hands) {
    const Target start = track.at(0);
    const hand::Poses poses = hand::forward_kinematics(start.palm, start.angles, track.model);
    EXPECT_LE(depth.of(poses, balls(track.model), 0.02), -0.00999) << what;
    for (std::size_t k = 1; k < track.keys.size(); ++k) EXPECT_GT(track.keys[k].time, track.keys[k - 1].time);
  }
  // The printed figures are those of the motion that comes back.
  double inside = 0;
  for (int k = 0; k <= 300; ++k) {
    double deepest = 0;
    for (const Track& track : motion.hands) {
      const Target at = track.at(motion.duration * k / 300);
      deepest =
          std::max(deepest, depth.of(hand::forward_kinematics(at.palm, at.angles, track.model), balls(track.model)));
    }
    inside += deepest > 0 ? 1.0 / 301 : 0;
  }
  EXPECT_NEAR(inside, placement.inside, 0.05) << what;
}

TEST(Placement, AMotionIsLoweredUntilItWorks) {
  for (const bool left : {false, true})
    expect_placed("made", read_motion(written("made.json", leap_document(60, true, left).dump())),
                  slab({0.5, 0.5, 0.05}));
}

// A hand that is a metre away for half of the time is in no block for most of it.
TEST(Placement, SaysWhereAShareCannotBeHad) {
  HandMotion motion = read_motion(written("made.json", leap_document(60, true, false).dump()));
  const auto notes = [](HandMotion placed) {
    place(placed, slab({0.08, 0.08, 0.08}), 0.8);
    return std::ranges::count_if(placed.notes, [](const auto& note) { return note.starts_with("at no height"); });
  };
  EXPECT_EQ(notes(motion), 0);
  for (Track& track : motion.hands)
    for (Track::Key& key : track.keys) key.target.palm.position.x() += key.time > motion.duration / 2 ? 1 : 0;
  EXPECT_EQ(notes(motion), 1);
}

TEST(Placement, OnAThinSheetAndOnASmallBlock) {
  const HandMotion motion = read_motion(written("made.json", leap_document(60, true, false).dump()));
  expect_placed("sheet", motion, slab({0.5, 0.5, 0.001}));
  expect_placed("block", motion, slab({0.08, 0.08, 0.08}));
}

// A loose block on the slab makes way: the hand must go into the slab.
TEST(Placement, LoosePartsDoNotCount) {
  const HandMotion motion = read_motion(written("made.json", leap_document(60, true, false).dump()));
  const Surroundings firm = slab({0.5, 0.5, 0.05});
  Surroundings about = firm;
  about.objects.push_back({.name = "block",
                           .pieces = {{collision::Shape::rounded_box({0.3, 0.3, 0.06}, 0.005)}},
                           .pose = {Vec3(0.3, 0.1, 0.531), Mat3::Identity()},
                           .mass = 1});
  HandMotion beside = motion, alone = motion;
  place(beside, about);
  place(alone, firm);
  const auto end = [](const HandMotion& m) { return m.hands[0].keys.back().target.palm.position; };
  EXPECT_EQ(end(beside), end(alone));
}

TEST(Placement, ALateHandDelaysNobodyAndStartsClear) {
  nlohmann::json document = leap_document(80, true, true);
  for (int n = 1; n <= 45; ++n) document["frames"][static_cast<std::size_t>(n)][2].erase(1);
  expect_placed("late", read_motion(written("late.json", document.dump())), slab({0.6, 0.5, 0.05}));
}

// A tracker's errors, hundreds of metres away: searched over, they took an hour, and the hand then touched nothing.
TEST(Placement, MomentsFarAwayDoNotCount) {
  HandMotion motion = read_motion(written("made.json", leap_document(60, true, false).dump()));
  for (std::size_t k = 10; k < 60; k += 20)
    motion.hands[0].keys[k].target.palm.position += Vec3(k == 10 ? 900 : 0, 0, k == 10 ? 0 : -900);
  expect_placed("far", motion, slab({0.5, 0.5, 0.05}));
}

TEST(Placement, RealRecordings) {
  const fs::path data = test::recorded_data();
  if (!fs::exists(data / "motion_leap_bones"))
    GTEST_SKIP() << "no motion_leap_bones in ZWANG_DATA or beside the sources";
  for (const char* folder : {"motion_leap_bones", "motion_dapg_door"})
    for (const auto& entry : fs::directory_iterator(data / folder))
      if (entry.path().extension() == ".json" || entry.path().extension() == ".csv")
        expect_placed(entry.path().stem(), read_motion(entry.path()), slab({0.5, 0.5, 0.05}));
}

}  // namespace
}  // namespace zwang::god
