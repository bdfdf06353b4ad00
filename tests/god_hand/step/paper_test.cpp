#include <cmath>

#include <zwang/constraints/revolute_joint.h>
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;

Options paper() {
  Options o = paper_method();
  o.verify = 0;
  return o;
}

Simulation with(const Surroundings& surroundings, GodObjects objects, const Options& options) {
  std::vector<GodObjects> clusters;
  clusters.push_back(std::move(objects));
  return Simulation(surroundings, std::move(clusters), options);
}

// docs/formulation.md, "What the printed method misses", 4: with its target as far behind a wall as it was before it, a
// body covers 1/2, 2/3, 3/4 ... of the way. What it met at the time of contact is a row with c = 0 in the next step,
// which keeps it where it is; in the step after that nothing is met there any more: two steps for each part.
TEST(Paper, TimeOfContactTwiceNeverReachesTheWall) {
  constexpr double radius = 0.01, way = 0.1, margin = 2e-3;  // of the way: sweeps stop 0.1 mm before the wall
  GodObjects objects;
  objects.add(box_body({0.02, 0.02, 0.02}, 0.1, {0, 0, radius + way}), Shape::sphere(radius));
  Simulation s = with(floor_of(), std::move(objects), paper());
  const Pose<double> target = posed(0, 0, radius - way);
  for (int n = 1; n <= 12; ++n) {
    double covered = 1 - (s.step(std::span(&target, 1)).god[0].position.z() - radius) / way;
    EXPECT_NEAR(covered, n / (n + 1.), margin) << n;
    const Frame& f = s.step(std::span(&target, 1));
    EXPECT_NEAR(1 - (f.god[0].position.z() - radius) / way, covered, 1e-9) << n;
    EXPECT_EQ(f.origin, Origin::constrained);
    EXPECT_GT(f.gap, 0);
  }
}

TEST(Paper, RowsAreWhatWasMetAndAskForNothing) {
  Options o = paper();
  o.toc_twice = false;
  Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.05)), o);
  int met = 0;
  for (int k = 0; k < 80; ++k) {
    const Frame& f = go(s, hand_at(posed(0, 0, 0.05 - 1e-3 * k), 0.2));
    ASSERT_GE(f.gap, 0) << k;
    EXPECT_EQ(f.kept, f.raw);
    EXPECT_LE(f.sub_steps, 1);
    EXPECT_LE(s.problem(0).c.lpNorm<Eigen::Infinity>(), 1e-8);  // m/s^2: rounding of 1e-14 m
    EXPECT_EQ(s.problem(0).size(), 96);
    met += f.kept > 0;
  }
  EXPECT_GT(met, 20);
}

// A hinge whose first body cannot move turns its second one, r from the anchor, by w about it. The linear step takes
// the centre r w along the tangent while the body turns by w: the anchor is off by r |(1 - cos w, w - sin w)|, whatever
// the solver. The commit cycle leaves it closed.
TEST(Paper, LinearStepOpensAHingeByWhatTheChordLeaves) {
  constexpr double r = 0.02, heavy = 1e9;
  for (const double turn : {0.01, 0.1, 0.5}) {
    for (const bool cycle : {false, true}) {
      GodObjects objects;
      objects.add(box_body({0.02, 0.02, 0.02}, heavy, {0, 0, 0}), Shape::sphere(0.005));
      const Body swung = box_body({0.01, 2 * r, 0.01}, 0.02, {0, r, 0});
      objects.add(swung, Shape::capsule(r, 0.004));
      objects.pass(0, 1);
      objects.scene.add(RevoluteJoint{{0, 1}, Vec3::Zero(), Vec3(0, -r, 0), Vec3::UnitX(), Vec3::UnitX()});
      Options o = paper();
      o.solver = "dual_active_set";
      if (cycle) o.commit = Options::Commit::cycle;
      Simulation s = with(Surroundings{.name = "nothing"}, std::move(objects), o);
      const Mat3 R = rotation(Vec3(turn, 0, 0));
      const std::vector<Pose<double>> target = {posed(0, 0, 0), {R * Vec3(0, r, 0), R}};
      const double I = swung.inertia(0, 0), m = swung.mass,
                   w = (m * r * r * std::sin(turn) + I * turn) / (m * r * r + I);
      const double open = s.step(target).separation;
      if (cycle)
        EXPECT_LE(open, 1e-15);
      else
        EXPECT_NEAR(open, r * std::hypot(1 - std::cos(w), w - std::sin(w)), 1e-6 * open) << turn;
    }
  }
}

TEST(Origin, SaysWhatAFrameCameFrom) {
  Simulation s = one_hand(floor_of(), hand_at(posed(0, 0, 0.15)));
  std::array<int, origin_names.size()> count{};
  for (int k = 0; k < 150; ++k) {
    const Frame& f = go(s, hand_at(posed(2e-4 * k, 0, 0.15 - 1.4e-3 * k), 0.3));
    ++count[static_cast<std::size_t>(f.origin)];
    EXPECT_EQ(f.held, f.origin == Origin::held);
    if (f.kept == 0) {
      EXPECT_EQ(f.origin, Origin::free) << k;
    }
    bool pushed = false;
    for (const FrameContact& c : f.contacts) pushed = pushed || c.push > 0;
    if (pushed) {
      EXPECT_NE(f.origin, Origin::free) << k;
    }
  }
  EXPECT_GT(count[0], 10);
  EXPECT_GT(count[1] + count[2] + count[3], 50);
}

}  // namespace
}  // namespace zwang::god
