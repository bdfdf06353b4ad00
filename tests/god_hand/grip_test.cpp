#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include "tests/god_hand/loose_box.h"
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

Options rough(double mu, double rate = 1000) {
  Options o = unverified();
  o.mu = mu;
  o.dt = 1 / rate;
  return o;
}

constexpr double pad_mass = 0.05, inside = 0.004;             // kg, m: how far the target of a pad is inside the box
constexpr double k_f = 1e4, weight = 0.2 * 9.81;              // 1/s^2, N
constexpr double squeeze = k_f * pad_mass * (inside + 2e-4);  // N: rows keep 0.2 mm

struct Pinched {
  double grip = 0, fallen = 0, creep = 0, error = 0;
  long contacts = 0;  // that press, of one pad
  int returned = 0;
};

// A box of 60 mm and 0.2 kg in the air between two pads, each on its spring; for so many seconds.
Pinched pinch(double mu, double rate, bool apart, double seconds, double stiffness = 0) {
  Surroundings air{.name = "air"};
  air.objects.push_back(loose_box(Vec3::Zero()));
  std::vector<GodObjects> clusters(apart ? 2 : 1);
  std::vector<Pose<double>> target;
  for (const double side : {-1.0, 1.0}) {
    const Vec3 widths(0.02, 0.03, 0.03);
    const Body body = box_body(widths, pad_mass, {side * (0.04 + 2e-4), 0, 0});
    clusters[apart && side > 0 ? 1 : 0].add(body, collision::Shape::rounded_box(widths, 0.002));
    target.push_back(posed(side * (0.04 - inside), 0, 0));
  }
  Options o = rough(mu, rate);
  o.force_stiffness = k_f;
  o.pads = stiffness;
  Simulation s(air, std::move(clusters), o);
  Pinched out;
  for (int k = 0; k < seconds * rate; ++k) {
    const Frame& f = s.step(target);
    EXPECT_GT(f.gap, 0) << k;
    out.returned += f.returned;
    out.grip = f.grip, out.fallen = -f.loose[0].position.z(), out.creep = f.creep;
    out.error = std::max(out.error, f.impulse_error);
    out.contacts = std::ranges::count_if(f.contacts, [](const FrameContact& c) { return c.push > 0; }) / 2;
  }
  return out;
}

TEST(Grip, HoldsABoxWithTheForceOfTheSpringsAtAnyRate) {
  for (const bool apart : {false, true})
    for (const double rate : {250.0, 500.0, 1000.0}) {
      if (apart && rate == 250) continue;  // each sees the other's force a step late: at 250 Hz the box is lost
      const Pinched p = pinch(0.8, rate, apart, 2);
      EXPECT_NEAR(p.grip, squeeze, 1e-3 * squeeze) << rate;
      EXPECT_NEAR(p.fallen, weight / (2 * k_f * pad_mass), 1e-2 * p.fallen) << rate;  // the springs give
      EXPECT_LE(p.creep, 1e-7) << rate;                                               // m/s
      EXPECT_LE(p.error, 1e-12) << rate;
      EXPECT_EQ(p.returned, 0) << rate;
    }
}

// Two contacts of mu N each carry the weight, or do not.
TEST(Grip, SlipsBelowTheLeastFrictionThatHolds) {
  const double least = weight / (2 * squeeze);
  const double sag = weight / (2 * k_f * pad_mass);
  const Pinched holds = pinch(1.01 * least, 1000, false, 2), slips = pinch(0.99 * least, 1000, false, 2);
  EXPECT_LT(holds.fallen, 1.2 * sag);
  EXPECT_LE(holds.creep, 1e-6);  // m/s
  EXPECT_GT(slips.fallen, 10 * sag);
  EXPECT_EQ(holds.returned + slips.returned, 0);
}

// Pads that give way are springs in series with those of the god objects: force, and least friction that holds.
TEST(Grip, SoftPadsPressAsSpringsInSeries) {
  for (const double stiffness : {1e6, 1e4, 1e3})
    for (const double rate : {250.0, 1000.0}) {
      const Pinched p = pinch(0.8, rate, false, 1, stiffness);
      ASSERT_EQ(p.contacts, 4);
      const double press = (inside + 2e-4) / (1 / (k_f * pad_mass) + 1 / (4 * stiffness));
      EXPECT_NEAR(p.grip, press, 1e-4 * press) << stiffness << " " << rate;
      EXPECT_LE(p.creep, 1e-9) << stiffness << " " << rate;  // m/s
      EXPECT_LE(p.error, 1e-12) << stiffness << " " << rate;
      EXPECT_EQ(p.returned, 0) << stiffness << " " << rate;
      const double least = weight / (2 * press);
      // So near the least friction contacts slide in turn before they rest, for how long depends on the last digits.
      EXPECT_LE(pinch(1.1 * least, rate, false, 5, stiffness).creep, 1e-6) << stiffness << " " << rate;
      EXPECT_LE(pinch(1.3 * least, rate, false, 1, stiffness).creep, 1e-6) << stiffness << " " << rate;
      EXPECT_GT(pinch(0.95 * least, rate, false, 1, stiffness).fallen, 10 * p.fallen) << stiffness << " " << rate;
    }
}

// The pads' targets go apart: nothing presses any more from the next frame on, at any rate. While they hold, and where
// one comes to rest inside, nothing is late.
TEST(Grip, LetsGoInTheNextFrame) {
  for (const double rate : {250.0, 1000.0}) {
    Surroundings air{.name = "air"};
    air.objects.push_back(loose_box(Vec3::Zero()));
    std::vector<GodObjects> clusters(1);
    for (const double side : {-1.0, 1.0}) {
      const Vec3 widths(0.02, 0.03, 0.03);
      clusters[0].add(box_body(widths, pad_mass, {side * (0.04 + 2e-4), 0, 0}),
                      collision::Shape::rounded_box(widths, 0.002));
    }
    Simulation s(air, std::move(clusters), rough(0.8, rate));
    const auto step = [&](double deep) {
      const std::vector<Pose<double>> target = {posed(deep - 0.04, 0, 0), posed(0.04 - deep, 0, 0)};
      return s.step(target);
    };
    for (int k = 0; k < rate / 2; ++k) {
      const Frame f = step(inside);
      EXPECT_EQ(f.late, 0) << k;
      EXPECT_TRUE(k < rate / 4 || f.grip > squeeze / 2) << k;
    }
    double late = 0;
    for (int k = 0; k < rate / 10; ++k) late = std::max(late, step(-0.01).late);
    EXPECT_LE(late, 1 / rate);
    EXPECT_EQ(step(-0.01).grip, 0);
  }
}

TEST(Grip, TheHandLiftsABoxBetweenThumbAndIndexFinger) {
  const Surroundings scene = make_surroundings("box", "");
  const HandMotion motion = synthetic_motion("lift", scene);
  Play play(scene, motion, rough(0.8, 500));
  Frame f;
  for (int k = 0; k <= 1500; ++k) {
    f = play.step(k);
    ASSERT_GT(f.gap, 0) << k;
    ASSERT_LE(f.separation, 1e-9) << k;
    ASSERT_LE(f.impulse_error, 1e-12) << k;
  }
  EXPECT_NEAR(f.loose[0].position.z(), 0.23, 0.002);  // m
  EXPECT_LE(f.slip, 1e-6);                            // m/s
  EXPECT_GT(f.grip, weight / 2 / 0.8);
}

// Of a tracker that is slower than the loop, and of a client that misses a step now and then.
TEST(Grip, TargetsThatComeUnevenlyLiftItToo) {
  const Surroundings scene = make_surroundings("box", "");
  const HandMotion motion = synthetic_motion("lift", scene);
  for (const bool slow : {false, true}) {
    Play play(scene, motion, rough(0.8, 500));
    Frame f;
    for (int k = 0, came = 0; k <= 1500; ++k) {
      if (slow ? k % 6 == 0 : k % 5 != 1 && k % 7 != 3 && k % 7 != 4) came = k;
      f = play.step(came);
      ASSERT_GT(f.gap, 0) << k;
    }
    EXPECT_NEAR(f.loose[0].position.z(), 0.23, 0.02) << slow;  // m
    EXPECT_LE(f.slip, 1e-6) << slow;                           // m/s
  }
}

// Half a second of going up. What the hand holds goes with it in the frame after a checkpoint, too.
TEST(Grip, ACheckpointDoesNotShakeWhatIsHeld) {
  const Surroundings scene = make_surroundings("box", "");
  const HandMotion motion = synthetic_motion("lift", scene);
  Play play(scene, motion, rough(0.8, 250)), stopped(scene, motion, rough(0.8, 250));
  for (int k = 0; k <= 525; ++k) {
    const Frame& f = play.step(k);
    if (k == 500) stopped.simulation().restore(stopped.simulation().checkpoint());
    const Frame& g = stopped.step(k);
    ASSERT_NEAR(g.grip, f.grip, 1e-6) << k;  // N
    ASSERT_NEAR(g.slip, f.slip, 1e-6) << k;  // m/s
  }
}

TEST(Grip, TheHandSetsItDownAndLetsGo) {
  const Surroundings scene = make_surroundings("box", "");
  const HandMotion motion = synthetic_motion("lift", scene);
  Play play(scene, motion, rough(0.8, 500));
  Frame f;
  for (int k = 0; k <= motion.duration * 500; ++k) f = play.step(k);
  const Vec3 from = scene.objects[1].pose.position, to = f.loose[0].position;
  EXPECT_NEAR((to - from).head<2>().norm(), 0.3, 0.005);
  EXPECT_NEAR(to.z(), 0.03, 1e-4);
  EXPECT_GT(f.loose[0].rotation(2, 2), 0.9999);
  EXPECT_EQ(f.grip, 0);
}

}  // namespace
}  // namespace zwang::god
