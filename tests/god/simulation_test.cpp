#include "experiments/god/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bench/collision/meshes.h"
#include "bench/scenes/physical.h"

namespace zwang::god {
namespace {

using collision::Shape;
using collision::Tree;

Object fixed(collision::Mesh mesh, const Pose<double>& pose = {}) {
  return {.name = "part", .mesh = std::make_shared<const Tree>(std::move(mesh)), .pose = pose};
}

// A floor whose top is at z = 0, of some thousand triangles.
Surroundings floor_of(std::size_t triangles = 5000) {
  Surroundings s{.name = "floor"};
  s.objects.push_back(fixed(meshes::plate({1, 1, 0.1}, triangles), {{0, 0, -0.05}, Mat3::Identity()}));
  return s;
}

Surroundings sheet() {
  Surroundings s{.name = "sheet"};
  s.objects.push_back(fixed(meshes::sheet(1, 1, 800)));
  return s;
}

Pose<double> at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) { return {{x, y, z}, rotation(turn)}; }

Target hand_at(const Pose<double>& palm, double curl = 0) {
  Target t{.palm = palm};
  for (int k = 0; k < hand::angles; ++k)
    if (k % 4 != 1) t.angles[static_cast<std::size_t>(k)] = curl * hand::range(k).high;
  return t;
}

Options unverified() {
  Options o;
  o.verify = false;
  return o;
}

Simulation one_hand(const Surroundings& surroundings, const Target& start, const Options& options = unverified()) {
  return Simulation(surroundings, std::span(&hand::standard(), 1), std::span(&start, 1), options);
}

const Frame& go(Simulation& simulation, const Target& target) { return simulation.step(std::span(&target, 1)); }

void expect_sound(const Frame& f) {
  ASSERT_GT(f.gap, 0) << "frame " << f.number;
  ASSERT_LE(f.separation, 1e-12) << "frame " << f.number;
  ASSERT_LE(f.limit, 1e-12) << "frame " << f.number;
  ASSERT_TRUE(f.claimed == Status::solved || f.claimed == Status::solved_ill_conditioned) << to_string(f.claimed);
}

TEST(Hand, ReachesAFreeTargetInOneStep) {
  const Target start = hand_at(at(0, 0, 0.5));
  Simulation s = one_hand(floor_of(), start);
  EXPECT_EQ(go(s, start).distance, 0);
  const Frame& f = go(s, hand_at(at(0.1, -0.2, 0.4, {0.5, 1, -0.7}), 0.4));
  EXPECT_LE(f.distance, 1e-12);
  expect_sound(f);
}

TEST(Hand, StaysOutsideOfAFloorItIsPressedInto) {
  Simulation s = one_hand(floor_of(), hand_at(at(0, 0, 0.05)));
  for (int k = 0; k < 300; ++k) {
    const double down = std::min(1.0, k / 150.0), z = 0.05 - 0.1 * down;
    const Frame& f = go(s, hand_at(at(0, 0, z, {0.2 * std::sin(0.02 * k), 0, 0}), 0.3 * down));
    expect_sound(f);
    EXPECT_FALSE(f.held);
    for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0.005);
  }
}

TEST(Hand, SlidesOverAFloorWithoutArtificialFriction) {
  Simulation s = one_hand(floor_of(), hand_at(at(-0.2, 0, 0.05)));
  for (int k = 0; k < 100; ++k) go(s, hand_at(at(-0.2, 0, 0.05 - 6e-4 * k), 0.2));
  for (int k = 0; k < 200; ++k) go(s, hand_at(at(-0.2, 0, -0.0094), 0.2));
  Vec3 before = go(s, hand_at(at(-0.2, 0, -0.0094), 0.2)).god[0].position;
  for (int k = 1; k <= 400; ++k) {
    const Frame& f = go(s, hand_at(at(-0.2 + 0.0005 * k, 0.0003 * k, -0.0094), 0.2));
    expect_sound(f);
    const Vec3 moved = f.god[0].position - before;
    before = f.god[0].position;
    ASSERT_NEAR(moved.x(), 0.0005, 1e-6 * 0.0005) << k;
    ASSERT_NEAR(moved.y(), 0.0003, 1e-6 * 0.0003) << k;
  }
}

TEST(Hand, NeverPopsThroughASheetOfNoThickness) {
  for (const double speed : {0.5, 5.0}) {
    Simulation s = one_hand(sheet(), hand_at(at(0, 0, 0.1)));
    for (int k = 0; k < 300; ++k) {
      const double z = std::max(-0.2, 0.1 - speed * 1e-3 * k);
      const Frame& f = go(s, hand_at(at(0.0001 * k, 0, z), 0.1));
      expect_sound(f);
      for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0) << speed << " m/s, frame " << k;
    }
  }
}

TEST(Hand, ComesBackAfterATeleportIfTheWayIsClear) {
  Simulation s = one_hand(sheet(), hand_at(at(0, 0, 0.1)));
  EXPECT_LE(go(s, hand_at(at(0.3, 0.2, 0.4, {0, 0, 2.5}), 0.4)).distance, 1e-12);
  // Through the sheet: the hand stays on its side.
  for (int k = 0; k < 50; ++k) {
    const Frame& f = go(s, hand_at(at(0, 0, -0.3), 0.4));
    expect_sound(f);
    for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0);
  }
  go(s, hand_at(at(0, 0, 0.2), 0.4));
  go(s, hand_at(at(0, 0, 0.2), 0.4));
  EXPECT_LE(go(s, hand_at(at(0, 0, 0.2), 0.4)).distance, 1e-12);
}

TEST(Hand, HoldsTheLastTargetWhereTrackingIsLostOrNotANumber) {
  Simulation s = one_hand(sheet(), hand_at(at(0, 0, 0.1)));
  Target lost = hand_at(at(0.2, 0, 0.1));
  lost.tracked = false;
  const Frame& f = go(s, lost);
  EXPECT_FALSE(f.tracked);
  EXPECT_EQ(f.god[0].position.x(), 0);
  Target nan = hand_at(at(0.2, 0, 0.1));
  nan.angles[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(go(s, nan).tracked);
  EXPECT_EQ(f.god[0].position.x(), 0);
  for (const Pose<double>& pose : f.god) EXPECT_TRUE(pose.position.allFinite() && pose.rotation.allFinite());
  EXPECT_LE(go(s, hand_at(at(0.2, 0, 0.1))).distance, 1e-12);
  EXPECT_TRUE(f.tracked);
}

}  // namespace
}  // namespace zwang::god
