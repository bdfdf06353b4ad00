#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;

// A right hand at -x and a left one at x, face to face, that far from the middle.
std::array<Target, 2> hands_at(double apart) { return {hand_at(posed(-apart, 0, 0.1)), hand_at(posed(apart, 0, 0.1))}; }

Simulation two_hands(const Surroundings& surroundings, const Options& options, double apart) {
  const std::array models = {hand::standard(), hand::mirrored(hand::standard())};
  return Simulation(surroundings, models, hands_at(apart), options);
}

// The smallest distance of a body of one hand to one of the other.
double between(const Frame& f, const std::vector<Shape>& shapes) {
  collision::World world;
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    const std::uint64_t mine = b < hand::bodies ? 1 : 2;
    world.add(shapes[b], f.god[b], {mine, 3 - mine});
  }
  double least = 0.05;
  for (const collision::Touch& t : world.touches(0.05)) least = std::min(least, t.gap);
  return least;
}

TEST(Meeting, HandsThatCrossTouchAndPartAgain) {
  Simulation s = two_hands(floor_of(), unverified(), 0.15);
  const std::vector<Shape> shapes = s.shapes();
  bool one = false, of_each_other = false;
  double least = 1;
  for (int k = 0; k < 700; ++k) {
    const double apart = k < 300 ? 0.15 - 6e-4 * k : -0.03 + 6e-4 * (k - 300);
    const Frame& f = s.step(hands_at(apart));
    ASSERT_EQ(f.god.size(), 32u);
    expect_sound(f);
    least = std::min(least, between(f, shapes));
    ASSERT_GT(least, 0) << k;
    one = one || s.problem(0).size() == 192;
    for (const FrameContact& c : f.contacts) of_each_other = of_each_other || (c.object < -hand::bodies && c.body < 16);
  }
  EXPECT_TRUE(one);
  EXPECT_TRUE(of_each_other);
  EXPECT_LT(least, 5e-4);
  EXPECT_EQ(s.problem(0).size(), 96);
  EXPECT_LT(s.step(hands_at(0.21)).distance, 1e-9);
}

TEST(Meeting, AHandThatJumpsThroughTheOtherDoesNot) {
  Simulation s = two_hands(floor_of(), unverified(), 0.15);
  const std::vector<Shape> shapes = s.shapes();
  for (int k = 0; k < 60; ++k) ASSERT_GT(between(s.step(hands_at(-0.15)), shapes), 0) << k;
}

// Far from each other they are what they were: the same bits.
TEST(Meeting, HandsApartDoNotNoticeEachOther) {
  Options pass = unverified();
  pass.hands_meet = false;
  Simulation meet = two_hands(floor_of(), unverified(), 0.2), alone = two_hands(floor_of(), pass, 0.2);
  for (int k = 0; k < 150; ++k) {
    std::array<Target, 2> at = hands_at(0.2 - 1e-4 * k);
    for (Target& t : at) t.palm.position.z() -= 8e-4 * k;
    const Frame &a = meet.step(at), &b = alone.step(at);
    for (std::size_t g = 0; g < a.god.size(); ++g) {
      ASSERT_EQ(a.god[g].position, b.god[g].position) << k;
      ASSERT_EQ(a.god[g].rotation, b.god[g].rotation) << k;
    }
  }
}

TEST(Meeting, ACheckpointHoldsIt) {
  Simulation s = two_hands(floor_of(), unverified(), 0.15), other = two_hands(floor_of(), unverified(), 0.15);
  for (int k = 0; k < 260; ++k) s.step(hands_at(0.15 - 6e-4 * k));
  ASSERT_EQ(s.problem(0).size(), 192);
  other.restore(s.checkpoint());
  for (int k = 0; k < 20; ++k) {
    const Frame &a = s.step(hands_at(0.0)), &b = other.step(hands_at(0.0));
    for (std::size_t g = 0; g < a.god.size(); ++g) ASSERT_EQ(a.god[g].position, b.god[g].position) << k;
  }
}

}  // namespace
}  // namespace zwang::god
