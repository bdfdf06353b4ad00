#include <cmath>
#include <limits>

#include <zwang/bench/collision/witness.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;
using collision::Tree;

TEST(Hand, ReachesAFreeTargetInOneStep) {
  const Target start = hand_at(posed(0, 0, 0.5));
  Simulation s = one_hand(floor_of(), start);
  EXPECT_EQ(go(s, start).distance, 0);
  const Frame& f = go(s, hand_at(posed(0.1, -0.2, 0.4, {0.5, 1, -0.7}), 0.4));
  EXPECT_LE(f.distance, 1e-12);
  expect_sound(f);
}

TEST(Hand, StaysOutsideOfAFloorItIsPressedInto) {
  Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)));
  for (int k = 0; k < 300; ++k) {
    const double down = std::min(1.0, k / 150.0), z = 0.05 - 0.1 * down;
    const Frame& f = go(s, hand_at(posed(0, 0, z, {0.2 * std::sin(0.02 * k), 0, 0}), 0.3 * down));
    expect_sound(f);
    EXPECT_FALSE(f.held);
    for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0.005);
  }
}

TEST(Hand, SlidesOverAFloorWithoutArtificialFriction) {
  Simulation s = one_hand(floor_of(), hand_at(posed(-0.2, 0, 0.05)));
  for (int k = 0; k < 100; ++k) go(s, hand_at(posed(-0.2, 0, 0.05 - 6e-4 * k), 0.2));
  for (int k = 0; k < 200; ++k) go(s, hand_at(posed(-0.2, 0, -0.0094), 0.2));
  Vec3 before = go(s, hand_at(posed(-0.2, 0, -0.0094), 0.2)).god[0].position;
  for (int k = 1; k <= 400; ++k) {
    const Frame& f = go(s, hand_at(posed(-0.2 + 0.0005 * k, 0.0003 * k, -0.0094), 0.2));
    expect_sound(f);
    const Vec3 moved = f.god[0].position - before;
    before = f.god[0].position;
    ASSERT_NEAR(moved.x(), 0.0005, 1e-6 * 0.0005) << k;
    ASSERT_NEAR(moved.y(), 0.0003, 1e-6 * 0.0003) << k;
  }
}

TEST(Hand, NeverPopsThroughASheetOfNoThickness) {
  for (const double speed : {0.5, 5.0}) {
    Simulation s = one_hand(sheet(), hand_at(posed(0, 0, 0.1)));
    for (int k = 0; k < 300; ++k) {
      const double z = std::max(-0.2, 0.1 - speed * 1e-3 * k);
      const Frame& f = go(s, hand_at(posed(0.0001 * k, 0, z), 0.1));
      expect_sound(f);
      for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0) << speed << " m/s, frame " << k;
    }
  }
}

TEST(Hand, ComesBackAfterATeleportIfTheWayIsClear) {
  Simulation s = one_hand(sheet(), hand_at(posed(0, 0, 0.1)));
  EXPECT_LE(go(s, hand_at(posed(0.3, 0.2, 0.4, {0, 0, 2.5}), 0.4)).distance, 1e-12);
  // Through the sheet: the hand stays on its side.
  for (int k = 0; k < 50; ++k) {
    const Frame& f = go(s, hand_at(posed(0, 0, -0.3), 0.4));
    expect_sound(f);
    for (const Pose<double>& pose : f.god) ASSERT_GT(pose.position.z(), 0);
  }
  go(s, hand_at(posed(0, 0, 0.2), 0.4));
  go(s, hand_at(posed(0, 0, 0.2), 0.4));
  EXPECT_LE(go(s, hand_at(posed(0, 0, 0.2), 0.4)).distance, 1e-12);
}

TEST(Hand, HoldsTheLastTargetWhereTrackingIsLostOrNotANumber) {
  Simulation s = one_hand(sheet(), hand_at(posed(0, 0, 0.1)));
  Target lost = hand_at(posed(0.2, 0, 0.1));
  lost.tracked = false;
  const Frame& f = go(s, lost);
  EXPECT_FALSE(f.tracked);
  EXPECT_EQ(f.god[0].position.x(), 0);
  Target nan = hand_at(posed(0.2, 0, 0.1));
  nan.angles[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(go(s, nan).tracked);
  EXPECT_EQ(f.god[0].position.x(), 0);
  for (const Pose<double>& pose : f.god) EXPECT_TRUE(pose.position.allFinite() && pose.rotation.allFinite());
  EXPECT_LE(go(s, hand_at(posed(0.2, 0, 0.1))).distance, 1e-12);
  EXPECT_TRUE(f.tracked);
}

// A box of fixed walls, inner width 0.3 m, about the origin.
Surroundings cavity() {
  Surroundings s{.name = "cavity"};
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1, 1}) {
      Vec3 widths = Vec3::Constant(0.4), middle = Vec3::Zero();
      widths[axis] = 0.02, middle[axis] = side * 0.16;
      s.objects.push_back(fixed(meshes::box(widths), {middle, Mat3::Identity()}));
    }
  return s;
}

TEST(Hand, AFistInABoxFindsNoWayOut) {
  Simulation s = one_hand(cavity(), hand_at(posed(0, -0.05, 0)));
  for (int k = 0; k < 400; ++k) {
    const double t = 0.02 * k;
    const Frame& f = go(s, hand_at(posed(0.3 * std::sin(t), 0.3 * std::sin(0.7 * t), 0.3 * std::sin(1.3 * t),
                                         {2 * std::sin(0.4 * t), std::sin(0.3 * t), 0}),
                                   0.5 - 0.5 * std::cos(t)));
    expect_sound(f);
    for (const Pose<double>& pose : f.god) ASSERT_LT(pose.position.cwiseAbs().maxCoeff(), 0.15) << k;
  }
}

TEST(Hand, KeepsItsLimitsWithTheRowsOfThePaperToo) {
  Options o = unverified();
  o.limits = Options::Limits::violated;
  Simulation predictive = one_hand(floor_of(), hand_at(posed(0, 0, 0.05))),
             violated = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)), o);
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const Target target = hand_at(posed(0, 0, 0.05 - 5e-4 * k, {0.004 * k, 0, 0}));
    expect_sound(go(predictive, target));
    worst = std::max(worst, go(violated, target).limit);
  }
  EXPECT_GT(worst, 1e-6);  // written when it is too late
  EXPECT_LT(worst, 0.1);
}

TEST(Hand, PrintedStepsLeaveTheJointsOpenAndTheCycleDoesNot) {
  Options printed = unverified();
  printed.commit = Options::Commit::printed;
  printed.limits = Options::Limits::violated;
  printed.solver = "nnls_paper";
  printed.sub_steps = 1;
  Simulation theirs = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)), printed),
             ours = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)));
  double open = 0;
  for (int k = 0; k < 150; ++k) {
    const Target target = hand_at(posed(0, 0, 0.05 - 6e-4 * k, {0.003 * k, 0, 0}), 0.002 * k);
    const Frame& f = go(theirs, target);
    ASSERT_GT(f.gap, 0);
    open = std::max(open, f.separation);
    expect_sound(go(ours, target));
  }
  EXPECT_GT(open, 1e-6);
}

TEST(Hand, TheTimeOfContactTwiceNeverArrives) {
  const auto last_gap = [](bool twice) {
    Options o = unverified();
    o.toc_twice = twice;
    o.sub_steps = 1;
    Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.3)), o);
    for (int k = 0; k < 3; ++k) go(s, hand_at(posed(0, 0, -0.3)));
    double low = 1;
    for (const Pose<double>& pose : go(s, hand_at(posed(0, 0, -0.3))).god) low = std::min(low, pose.position.z());
    return low;
  };
  EXPECT_GT(last_gap(true), last_gap(false) + 1e-4);
}

TEST(Hand, SameMotionSameBits) {
  std::vector<Pose<double>> last[2];
  for (auto& poses : last) {
    Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)));
    for (int k = 0; k < 150; ++k)
      poses = go(s, hand_at(posed(3e-4 * k, 0, 0.05 - 5e-4 * k, {0, 0.002 * k, 0}), 0.002 * k)).god;
  }
  for (std::size_t b = 0; b < last[0].size(); ++b) {
    EXPECT_EQ(last[0][b].position, last[1][b].position);
    EXPECT_EQ(last[0][b].rotation, last[1][b].rotation);
  }
}

// FCL's own word on it, in a scene of several meshes.
TEST(Hand, AuditedByFcl) {
  const Surroundings pegs = make_surroundings("pegs", "");
  std::vector<std::shared_ptr<const Tree>> meshes;
  for (const Object& o : pegs.objects) meshes.push_back(o.mesh);
  const Witness witness(meshes);
  Simulation s = one_hand(pegs, hand_at(posed(pegs.focus.x(), pegs.focus.y() - 0.1, 0.1)));
  const std::vector<Shape> shapes = s.shapes();
  double deepest = 0;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.01 * k;
    const Frame& f = go(s, hand_at(posed(pegs.focus.x() + 0.05 * std::sin(t), -0.1, 0.06 - 0.1 * std::min(1.0, t)),
                                   0.2 - 0.2 * std::cos(t)));
    expect_sound(f);
    deepest = std::max(deepest, f.target_depth);
    for (std::size_t b = 0; b < shapes.size(); ++b)
      for (std::size_t m = 0; m < meshes.size(); ++m)
        ASSERT_FALSE(witness.overlaps(shapes[b], f.god[b], m, pegs.objects[m].pose)) << "frame " << k << ", body " << b;
  }
  EXPECT_GT(deepest, 0.005);
}

}  // namespace
}  // namespace zwang::god
