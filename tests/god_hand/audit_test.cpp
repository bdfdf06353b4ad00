#include <zwang/bench/collision/audit.h>

#include <gtest/gtest.h>

#include <zwang/experiments/god_hand/hand/hand_shapes.h>
#include <zwang/experiments/god_hand/run/hand_study.h>

namespace zwang::god {
namespace {

// A wedge of six corners, a box and a sphere, each met by a hand that is lowered into it.
TEST(Audit, FindsAHandInsideEachKindOfObject) {
  using collision::Shape;
  const std::vector<Vec3> wedge = {{-0.2, -0.2, -0.02}, {0.2, -0.2, -0.02}, {-0.2, 0.2, -0.02},
                                   {0.2, 0.2, -0.02},   {-0.2, 0, 0.03},    {0.2, 0, 0.03}};
  for (const Shape& shape :
       {Shape::hull(wedge, 0.002), Shape::rounded_box({0.4, 0.4, 0.06}, 0.003), Shape::sphere(0.03)})
    for (const auto& [height, inside] : {std::pair(0.04, true), {0.06, false}}) {
      Audit audit({hand::shapes(hand::standard())}, {shape});
      const hand::Poses bodies = hand::forward_kinematics({{0, 0, height}, Mat3::Identity()}, {});
      const Pose<double> still;
      EXPECT_EQ(audit.check(bodies, std::span(&still, 1)) > 0, inside)
          << "core " << static_cast<int>(shape.core()) << " at " << height;
      EXPECT_EQ(audit.checked(), 16);
    }
}

// The left hand's palm within the right one's: counted once for each of its bodies, by the later hand.
TEST(Audit, CountsHandsThatCrossApart) {
  const auto shapes = hand::shapes(hand::standard());
  Audit audit({shapes, shapes}, {});
  std::vector<Pose<double>> bodies;
  for (const double x : {0., 0.02}) {
    const hand::Poses one = hand::forward_kinematics({{x, 0, 0}, Mat3::Identity()}, {});
    bodies.insert(bodies.end(), one.begin(), one.end());
  }
  EXPECT_EQ(audit.check(bodies, {}), 0);
  EXPECT_GT(audit.crossed(), 0);
  EXPECT_EQ(audit.checked(), 32);
}

// The shipped hand, in every scene of the collision suite that needs no files.
void expect_nothing_passes(HandRun run, int frames) {
  long touching = 0, bodies = 0;
  for (HandScene scene : hand_scenes({})) {
    scene.frames = frames;
    const HandStudy s = study_hand(scene, scene.make(), scene.speeds.back(), run);
    EXPECT_EQ(s.penetrations, 0) << scene.name;
    EXPECT_EQ(s.overlaps, 0) << scene.name;
    EXPECT_GT(s.gap, 1e-6) << scene.name;
    EXPECT_GE(s.audited, s.body_frames) << scene.name;
    // A hand that turns half a radian a frame touches in few of them.
    EXPECT_GT(s.touching, scene.name == "turning 0.5 rad a frame" ? 5 : 50) << scene.name;
    touching += s.touching;
    bodies += s.body_frames;
  }
  EXPECT_GT(touching, bodies / 4);
}

TEST(Audit, NothingPassesWhereverTheHandIsMoved) { expect_nothing_passes(HandRun::audited, 320); }

TEST(Audit, NothingPassesWithFriction) { expect_nothing_passes(HandRun::audited_with_friction, 160); }

}  // namespace
}  // namespace zwang::god
