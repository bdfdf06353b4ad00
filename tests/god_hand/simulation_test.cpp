#include <limits>

#include <zwang/constraints/ball_joint.h>
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;

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
  Simulation s = with(floor_of(), one_body(posed(0, 0, 0.1)));
  Pose<double> target = posed(0, 0, -0.01);
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
    ASSERT_GT(f.palm_wrench[2], 1);  // what pushes the user back up
  }
}

TEST(Chain, StaysClosedOverAnEdge) {
  GodObjects objects;
  constexpr double length = 0.05;
  std::vector<Pose<double>> target;
  for (int k = 0; k < 6; ++k) {
    target.push_back(posed(0, length * k, 0.1));
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
    target.push_back(posed(0.06 * k, 0, 0));
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

TEST(Simulation, VerifiedFramesDoNotDependOnTheSolver) {
  std::vector<Pose<double>> last[2];
  for (int k = 0; k < 2; ++k) {
    Options o = unverified();
    o.solver = k == 0 ? "dual_active_set" : "cholesky";
    o.verify = 1;
    Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.02)), o);
    for (int frame = 0; frame < 40; ++frame) {
      const Frame& f = go(s, hand_at(posed(2e-4 * frame, 0, 0.02 - 1e-3 * frame), 0.2));
      EXPECT_EQ(f.verified, Verdict::solved) << o.solver << " frame " << frame;
      last[k] = f.god;
    }
  }
  for (std::size_t b = 0; b < last[0].size(); ++b) EXPECT_LE((last[0][b].position - last[1][b].position).norm(), 1e-6);
}

TEST(Simulation, RefusesWhatItCannotDoInOneLine) {
  Options o = unverified();
  o.solver = "dual_activ_set";
  EXPECT_THROW(one_hand(floor_of(), hand_at(posed(0, 0, 0.1)), o), std::invalid_argument);
  Target nan = hand_at(posed(0, 0, 0.1));
  nan.palm.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(one_hand(floor_of(), nan), std::runtime_error);
  EXPECT_THROW(with(floor_of(), GodObjects{}), std::invalid_argument);
  EXPECT_THROW(one_hand(floor_of(), hand_at(posed(0, 0, 0.1))).step(std::span<const Target>{}), std::invalid_argument);
}

}  // namespace
}  // namespace zwang::god
