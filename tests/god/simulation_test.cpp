#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bench/collision/witness.h"
#include "constraints/ball_joint.h"
#include "experiments/god/scenes.h"
#include "tests/god/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;
using collision::Tree;

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
  Simulation s = one_hand(cavity(), hand_at(at(0, -0.05, 0)));
  for (int k = 0; k < 400; ++k) {
    const double t = 0.02 * k;
    const Frame& f = go(s, hand_at(at(0.3 * std::sin(t), 0.3 * std::sin(0.7 * t), 0.3 * std::sin(1.3 * t),
                                      {2 * std::sin(0.4 * t), std::sin(0.3 * t), 0}),
                                   0.5 - 0.5 * std::cos(t)));
    expect_sound(f);
    for (const Pose<double>& pose : f.god) ASSERT_LT(pose.position.cwiseAbs().maxCoeff(), 0.15) << k;
  }
}

TEST(Hand, KeepsItsLimitsWithTheRowsOfThePaperToo) {
  Options o = unverified();
  o.limits = Options::Limits::violated;
  Simulation predictive = one_hand(floor_of(), hand_at(at(0, 0, 0.05))),
             violated = one_hand(floor_of(), hand_at(at(0, 0, 0.05)), o);
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const Target target = hand_at(at(0, 0, 0.05 - 5e-4 * k, {0.004 * k, 0, 0}));
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
  Simulation theirs = one_hand(floor_of(), hand_at(at(0, 0, 0.05)), printed),
             ours = one_hand(floor_of(), hand_at(at(0, 0, 0.05)));
  double open = 0;
  for (int k = 0; k < 150; ++k) {
    const Target target = hand_at(at(0, 0, 0.05 - 6e-4 * k, {0.003 * k, 0, 0}), 0.002 * k);
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
    Simulation s = one_hand(floor_of(), hand_at(at(0, 0, 0.3)), o);
    for (int k = 0; k < 3; ++k) go(s, hand_at(at(0, 0, -0.3)));
    double low = 1;
    for (const Pose<double>& pose : go(s, hand_at(at(0, 0, -0.3))).god) low = std::min(low, pose.position.z());
    return low;
  };
  EXPECT_GT(last_gap(true), last_gap(false) + 1e-4);
}

TEST(Hand, SameMotionSameBits) {
  std::vector<Pose<double>> last[2];
  for (auto& poses : last) {
    Simulation s = one_hand(floor_of(), hand_at(at(0, 0, 0.05)));
    for (int k = 0; k < 150; ++k)
      poses = go(s, hand_at(at(3e-4 * k, 0, 0.05 - 5e-4 * k, {0, 0.002 * k, 0}), 0.002 * k)).god;
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
  Simulation s = one_hand(pegs, hand_at(at(pegs.focus.x(), pegs.focus.y() - 0.1, 0.1)));
  const std::vector<Shape> shapes = s.shapes();
  double deepest = 0;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.01 * k;
    const Frame& f = go(s, hand_at(at(pegs.focus.x() + 0.05 * std::sin(t), -0.1, 0.06 - 0.1 * std::min(1.0, t)),
                                   0.2 - 0.2 * std::cos(t)));
    expect_sound(f);
    deepest = std::max(deepest, f.target_depth);
    for (std::size_t b = 0; b < shapes.size(); ++b)
      for (std::size_t m = 0; m < meshes.size(); ++m)
        ASSERT_FALSE(witness.overlaps(shapes[b], f.god[b], m, pegs.objects[m].pose)) << "frame " << k << ", body " << b;
  }
  EXPECT_GT(deepest, 0.005);
}

// Section 3 of the paper.
GodObjects one_body(const Pose<double>& pose) {
  GodObjects objects;
  Body body = box_body({0.06, 0.08, 0.04}, 0.3, pose.position);
  body.pose = pose;
  objects.add(body, Shape::rounded_box({0.06, 0.08, 0.04}, 0.005));
  return objects;
}

Simulation with(const Surroundings& surroundings, GodObjects objects) {
  std::vector<GodObjects> clusters;
  clusters.push_back(std::move(objects));
  return Simulation(surroundings, std::move(clusters), unverified());
}

TEST(SingleBody, SlidesOnAFloorAndIsHeldUpByIt) {
  Simulation s = with(floor_of(), one_body(at(0, 0, 0.1)));
  Pose<double> target = at(0, 0, -0.01);
  for (int k = 0; k < 20; ++k) s.step(std::span(&target, 1));
  Vec3 before = s.step(std::span(&target, 1)).god[0].position;
  EXPECT_NEAR(before.z(), 0.0202, 1e-6);
  for (int k = 0; k < 200; ++k) {
    target.position += Vec3(4e-4, -2e-4, 0);
    const Frame& f = s.step(std::span(&target, 1));
    const Vec3 moved = f.god[0].position - before;
    before = f.god[0].position;
    ASSERT_LE((moved - Vec3(4e-4, -2e-4, 0)).norm(), 1e-6 * moved.norm()) << k;
    ASSERT_LE(f.lost_slide, 1e-6 * moved.norm()) << k;
    ASSERT_GT(f.device[2], 1);  // what pushes the user back up
  }
}

TEST(Chain, StaysClosedOverAnEdge) {
  GodObjects objects;
  constexpr double length = 0.05;
  std::vector<Pose<double>> target;
  for (int k = 0; k < 6; ++k) {
    target.push_back(at(0, length * k, 0.1));
    Body link = box_body({0.014, length, 0.014}, 0.02, target.back().position);
    objects.add(link, Shape::capsule(length, 0.007));
    if (k == 0) continue;
    objects.scene.add(BallJoint{{k - 1, k}, Vec3(0, length / 2, 0), Vec3(0, -length / 2, 0)});
    objects.pass(k - 1, k);
  }
  Surroundings edge{.name = "edge"};
  edge.objects.push_back(fixed(meshes::box({1, 0.1, 0.1}), {{0, 0.1, 0}, Mat3::Identity()}));
  Simulation s = with(edge, std::move(objects));
  double bent = 0;
  for (int k = 0; k < 300; ++k) {
    for (Pose<double>& t : target) t.position.z() -= 5e-4;
    const Frame& f = s.step(target);
    ASSERT_GT(f.gap, 0);
    ASSERT_LE(f.separation, 1e-12);
    bent = std::max(bent, (f.god[0].rotation.col(1) - f.god[5].rotation.col(1)).norm());
  }
  EXPECT_GT(bent, 0.5);  // both ends hang down
}

TEST(SeveralBodies, MeetEachOther) {
  GodObjects objects;
  std::vector<Pose<double>> target;
  for (int k = 0; k < 4; ++k) {
    target.push_back(at(0.06 * k, 0, 0));
    Body ball = box_body({0.04, 0.04, 0.04}, 0.1, target.back().position);
    objects.add(ball, Shape::sphere(0.02));
  }
  Surroundings nothing{.name = "nothing"};
  Simulation s = with(nothing, std::move(objects));
  for (Pose<double>& t : target) t.position.x() *= 0.2;  // all want to be in one place
  for (int k = 0; k < 300; ++k) ASSERT_GT(s.step(target).gap, 0);
  const Frame& f = s.step(target);
  for (int k = 1; k < 4; ++k)
    EXPECT_NEAR(f.god[static_cast<std::size_t>(k)].position.x() - f.god[static_cast<std::size_t>(k) - 1].position.x(),
                0.0402, 1e-5);
}

struct Pushed {
  double moved, speed, error, returned;
};

// A hand slides along the table for 0.8 s and pushes the box on it.
Pushed push_box(double rate) {
  Options o = unverified();
  o.dt = 1 / rate;
  Simulation s = one_hand(make_surroundings("box", ""), hand_at(at(-0.02, 0, 0.035)), o);
  Pushed out{};
  for (int k = 0; k < 1.4 * rate; ++k) {
    const Frame& f = go(s, hand_at(at(-0.02 + 0.3 * std::min(k / rate, 0.8), 0, 0.035)));
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
  targets = {hand_at(at(-0.05, 0, 0.035)), hand_at(at(0.31, 0, 0.035))};
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
  const std::string checkpoint = through.checkpoint();
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
  EXPECT_THROW(resumed.restore("1 0x1p+0"), std::runtime_error);
}

TEST(Simulation, VerifiedFramesDoNotDependOnTheSolver) {
  std::vector<Pose<double>> last[2];
  for (int k = 0; k < 2; ++k) {
    Options o;
    o.solver = k == 0 ? "dual_active_set" : "cholesky";
    o.verify = 1;
    Simulation s = one_hand(floor_of(), hand_at(at(0, 0, 0.02)), o);
    for (int frame = 0; frame < 40; ++frame) {
      const Frame& f = go(s, hand_at(at(2e-4 * frame, 0, 0.02 - 1e-3 * frame), 0.2));
      EXPECT_EQ(f.verified, Verdict::solved) << o.solver << " frame " << frame;
      last[k] = f.god;
    }
  }
  for (std::size_t b = 0; b < last[0].size(); ++b) EXPECT_LE((last[0][b].position - last[1][b].position).norm(), 1e-6);
}

TEST(Simulation, RefusesWhatItCannotDoInOneLine) {
  Options o = unverified();
  o.solver = "dual_activ_set";
  EXPECT_THROW(one_hand(floor_of(), hand_at(at(0, 0, 0.1)), o), std::invalid_argument);
  Target nan = hand_at(at(0, 0, 0.1));
  nan.palm.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(one_hand(floor_of(), nan), std::runtime_error);
  EXPECT_THROW(with(floor_of(), GodObjects{}), std::invalid_argument);
  EXPECT_THROW(one_hand(floor_of(), hand_at(at(0, 0, 0.1))).step(std::span<const Target>{}), std::invalid_argument);
}

}  // namespace
}  // namespace zwang::god
