#include <zwang/experiments/god_hand/scenes/scenes.h>
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

struct Pushed {
  double moved, speed, error, returned;
};

// A hand slides along the table for 0.8 s and pushes the box on it.
Pushed push_box(double rate) {
  Options o = unverified();
  o.dt = 1 / rate;
  Simulation s = one_hand(make_surroundings("box", ""), hand_at(posed(-0.02, 0, 0.035)), o);
  Pushed out{};
  for (int k = 0; k < 1.4 * rate; ++k) {
    const Frame& f = go(s, hand_at(posed(-0.02 + 0.3 * std::min(k / rate, 0.8), 0, 0.035)));
    EXPECT_GT(f.gap, 0);
    EXPECT_LE(f.separation, 1e-12);
    out.moved = f.loose[0].position.x() - 0.13;
    out.speed = std::max(out.speed, f.object_speed);
    out.error = std::max(out.error, f.impulse_error);
    out.returned += f.returned;
  }
  return out;
}

TEST(Coupling, TheSamePushAtThreeRatesMovesABoxEqually) {
  const Pushed slow = push_box(250), middle = push_box(500), fast = push_box(1000);
  EXPECT_GT(fast.moved, 0.05);
  for (const Pushed& p : {slow, middle, fast}) {
    EXPECT_NEAR(p.moved, fast.moved, 0.1 * fast.moved);
    EXPECT_LT(p.speed, 2 * 0.3);
    EXPECT_LE(p.error, 1e-12);
    EXPECT_EQ(p.returned, 0);
  }
}

// Both hands, with the box between them: their forces add up, so it stays where it is.
Simulation two_hands(const Options& options, std::array<Target, 2>& targets) {
  const std::array<hand::Model, 2> models{hand::standard(), hand::mirrored(hand::standard())};
  targets = {hand_at(posed(-0.05, 0, 0.035)), hand_at(posed(0.31, 0, 0.035))};
  return Simulation(make_surroundings("box", ""), models, targets, options);
}

TEST(Coupling, TwoHandsHoldABoxBetweenThem) {
  for (const bool clusters : {true, false}) {
    Options o = unverified();
    o.clusters = clusters;
    std::array<Target, 2> targets;
    Simulation s = two_hands(o, targets);
    double start = 0, most = 0;
    for (int k = 0; k < 800; ++k) {
      for (const int h : {0, 1}) targets[static_cast<std::size_t>(h)].palm.position.x() += (h == 0 ? 2e-4 : -2e-4);
      const Frame& f = s.step(targets);
      ASSERT_GT(f.gap, 0);
      ASSERT_LE(f.separation, 1e-12);
      if (k == 0) start = f.loose[0].position.x();
      double left = 0, right = 0;
      for (const FrameContact& c : f.contacts)
        if (c.object == 1) (c.body < hand::bodies ? left : right) += c.push;
      most = std::max(most, std::min(left, right));
      EXPECT_NEAR(f.loose[0].position.x(), start, 0.03);
    }
    EXPECT_GT(most, 0.2) << clusters;  // N, of both at once
  }
}

TEST(Checkpoint, GoesOnWithTheSameBits) {
  std::array<Target, 2> targets;
  const auto run = [&](Simulation& s, int from, int to) {
    Frame last;
    for (int k = from; k < to; ++k) {
      for (const int h : {0, 1})
        targets[static_cast<std::size_t>(h)].palm.position.x() = (h == 0 ? -0.05 : 0.31) + (h == 0 ? 3e-4 : -3e-4) * k;
      last = s.step(targets);
    }
    return last;
  };
  Simulation through = two_hands(unverified(), targets), resumed = two_hands(unverified(), targets);
  run(through, 0, 250);
  const std::vector<double> checkpoint = through.checkpoint();
  const Frame a = run(through, 250, 350);
  resumed.restore(checkpoint);
  const Frame b = run(resumed, 250, 350);
  EXPECT_EQ(a.number, b.number);
  EXPECT_EQ(a.jitter, b.jitter);
  for (std::size_t k = 0; k < a.god.size(); ++k) {
    ASSERT_EQ(a.god[k].position, b.god[k].position);
    ASSERT_EQ(a.god[k].rotation, b.god[k].rotation);
  }
  EXPECT_EQ(a.loose[0].position, b.loose[0].position);
  EXPECT_EQ(a.loose[0].rotation, b.loose[0].rotation);
  EXPECT_THROW(resumed.restore(std::vector<double>{1, 1}), std::runtime_error);
}

}  // namespace
}  // namespace zwang::god
