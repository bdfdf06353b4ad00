#include <gtest/gtest.h>

#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

// A fist on a table is opened, while the hand is tracked somewhat above and turned. Straight to the targets, each
// finger unrolls by three radians at once: it goes down before it goes up, where the linear rows see it leave. All the
// same the hand must find its way.
TEST(Release, AFistThatOpensOnATableIsNeverStuck) {
  Draw draw(1);
  Surroundings s{.name = "floor"};
  s.objects.push_back(fixed(meshes::plate({1, 1, 0.1}, 5000), {{0, 0, -0.05}, Mat3::Identity()}));
  for (int round = 0; round < 16; ++round) {
    const double z = draw.uniform(0.03, 0.06), curl = draw.uniform(0.7, 1);
    const Vec3 turn = draw.cube(0.3), aside = draw.cube(0.03);
    Simulation simulation = one_hand(s, hand_at(posed(0, 0, 0.15, turn), curl));
    for (int k = 0; k < 100; ++k) go(simulation, hand_at(posed(0, 0, 0.15 + (z - 0.15) * k / 100, turn), curl));
    const Target away = hand_at(posed(aside.x(), aside.y(), z + draw.uniform(0, 0.05), Vec3(turn + draw.cube(0.3))));
    for (int k = 0; k < 200; ++k) {
      const Frame& f = go(simulation, away);
      ASSERT_GT(f.gap, 0);
      EXPECT_FALSE(f.stuck) << "round " << round << ", frame " << k;
    }
  }
}

// A hand at rest on a table still trembles by nanometres, to and fro. That must not have taught it to take steps of
// nanometres: where tracking comes back 20 mm aside, it slides there.
TEST(Release, RestTeachesNoCaution) {
  Draw draw(1);
  const Surroundings s = floor_of();
  for (int round = 0; round < 8; ++round) {
    const double curl = draw.uniform(0, 1);
    const Vec3 turn = draw.cube(0.3);
    Simulation simulation = one_hand(s, hand_at(posed(0, 0, 0.08, turn), curl));
    for (int k = 0; k < 100; ++k) go(simulation, hand_at(posed(0, 0, 0.08 - 5e-4 * k, turn), curl));
    double rest = 0, aside = 0;
    for (int k = 0; k < 200; ++k) rest = go(simulation, hand_at(posed(0, 0, 0.03, turn), curl)).distance;
    for (int k = 0; k < 60; ++k) aside = go(simulation, hand_at(posed(0.02, 0, 0.03, turn), curl)).distance;
    EXPECT_NEAR(aside, rest, 1e-6) << "round " << round;
  }
}

// Tracking comes back 40 mm on while the hand presses: rows for what is within a stride of that length would be
// hundreds.
TEST(Release, AJumpIsNotAPaceToKeep) {
  Surroundings s{.name = "floor"};
  s.objects.push_back(fixed(meshes::plate({1, 1, 0.1}, 200000), {{0, 0, -0.05}, Mat3::Identity()}));
  Simulation simulation = one_hand(s, hand_at(posed(0, 0, 0.05), 0.2));
  for (int k = 0; k < 200; ++k) go(simulation, hand_at(posed(0, 0, 0.05 - 3e-4 * k), 0.2));
  const int still = go(simulation, hand_at(posed(0, 0, -0.01), 0.2)).raw;
  EXPECT_LT(go(simulation, hand_at(posed(0.04, 0, -0.01), 0.2)).raw, 2 * still);
}

}  // namespace
}  // namespace zwang::god
