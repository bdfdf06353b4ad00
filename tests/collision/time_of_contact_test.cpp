#include <gtest/gtest.h>

#include <numbers>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/scenes/physical.h>
#include "tests/collision/placed.h"

namespace zwang::collision {
namespace {

using std::numbers::pi;

constexpr double stop = 1e-4;  // m, of Margins

Vec<double, 6> twist(const Vec3& linear, const Vec3& angular = Vec3::Zero()) {
  Vec<double, 6> t;
  t << linear, angular;
  return t;
}

// Never late: at least half the stop distance is left. Early by no more than 1e-6 of the motion plus the stop distance:
// the exact motion of a body swept by the stop distance would have come no farther than that.
struct Answer {
  double time, gap;
};

struct Duel {
  World world;
  int body = -1;
  explicit Duel(const Shape& shape, const Pose<double>& pose, const Mesh& mesh, const Pose<double>& of_mesh = {}) {
    world.add(tree(mesh), of_mesh);
    body = world.add(shape, pose);
  }
  TimeOfContact go(const Vec<double, 6>& motion) {
    const Move move{body, motion};
    return world.time_of_contact({&move, 1});
  }
};

const Mesh floor_sheet = meshes::sheet(2, 2, 2000);

TEST(TimeOfContact, SphereOnPlane) {
  for (const double speed : {0.2, 1.0, 5.0})
    for (const double sideways : {0.0, 0.1, 0.7}) {
      Duel s(Shape::sphere(0.01), at({0, 0, 0.06}), floor_sheet);
      const TimeOfContact toc = s.go(twist({sideways, 0, -speed}));
      const double touch = 0.05 / speed, early = (0.05 - stop) / speed;
      EXPECT_LT(toc.time, touch) << "late";
      EXPECT_GE(toc.time, early - 1e-6) << "early";
      EXPECT_EQ(toc.b, s.body == toc.a ? 0 : -1);
    }
}

TEST(TimeOfContact, ThroughASheetFromBothSides) {
  for (const double side : {-1.0, 1.0}) {
    Duel s(Shape::sphere(0.001), at({0.013, 0.007, 2.5 * side}), floor_sheet);
    const TimeOfContact toc = s.go(twist({0, 0, -5 * side}));
    EXPECT_LT(toc.time, 2.499 / 5);
    EXPECT_GE(toc.time, (2.499 - stop) / 5 - 1e-6);
  }
}

TEST(TimeOfContact, CapsuleOnEdge) {
  // The edge x = 0.1 of a box's top (z = 0.05), a capsule along y turned by 30 degrees about z, coming down.
  for (const double length : {0.02, 0.3}) {
    Duel s(Shape::capsule(length, 0.01), at({0.1, 0, 0.2}, {0, 0, pi / 6}), meshes::box({0.2, 1, 0.1}));
    const TimeOfContact toc = s.go(twist({0.005, 0, -0.3}));
    EXPECT_LT(toc.time, 0.14 / 0.3);
    EXPECT_GE(toc.time, (0.14 - stop) / 0.3 - 1e-6);
  }
}

TEST(TimeOfContact, TurningBoxOnPlane) {
  // A rounded box turning about its centre at height 0.08: its lowest point is at 0.08 - r - |R' e_z| . half.
  const Vec3 widths(0.2, 0.1, 0.04);
  const double r = 0.005, height = 0.08;
  Duel s(Shape::rounded_box(widths, r), at({0, 0, height}), floor_sheet);
  const double angle = 1.5;
  const TimeOfContact toc = s.go(twist(Vec3::Zero(), {0, angle, 0}));
  const auto gap = [&](double t) {
    return height - r - (widths.x() / 2 - r) * std::sin(angle * t) - (widths.z() / 2 - r) * std::cos(angle * t);
  };
  EXPECT_GT(gap(toc.time), 0.49 * stop);
  EXPECT_LE(gap(toc.time), stop + 1e-6);
  EXPECT_GT(gap(0.5 * toc.time), stop);
}

TEST(TimeOfContact, TurningMeshOnRestingSphere) {
  // The same seen from the other side: a bar turns about its middle and meets a sphere.
  World world;
  const int bar = world.add(tree(meshes::box({0.4, 0.02, 0.02})));
  world.add(Shape::sphere(0.01), at({0.15, 0.1, 0}));
  const Move move{bar, twist(Vec3::Zero(), {0, 0, 1.2})};
  const TimeOfContact toc = world.time_of_contact({&move, 1});
  const double direction = std::atan2(0.1, 0.15), far = std::hypot(0.15, 0.1);
  const auto gap = [&](double t) { return far * std::sin(direction - 1.2 * t) - 0.01 - 0.01; };
  EXPECT_GT(gap(toc.time), 0.49 * stop);
  EXPECT_LE(gap(toc.time), stop + 1e-6);
}

TEST(TimeOfContact, GrazingPassesAndGrazingHitsStop) {
  // Past the sharp edge of a box: the sphere's lowest point runs `over` above the top face.
  for (const double over : {1.5 * stop, 3 * stop, 1e-3}) {
    Duel s(Shape::sphere(0.01), at({-0.5, 0, 0.06 + over}), meshes::box({0.2, 0.2, 0.1}));
    EXPECT_EQ(s.go(twist({1, 0, 0})).time, 1) << over;
  }
  // Just under it: first contact where the circle reaches the edge x = -0.1.
  for (const double under : {1e-5, 1e-3}) {
    Duel s(Shape::sphere(0.01), at({-0.5, 0, 0.06 - under}), meshes::box({0.2, 0.2, 0.1}));
    const double h = 0.01 - under;
    const auto reach = [&](double r) { return 0.4 - std::sqrt(r * r - h * h); };
    const TimeOfContact toc = s.go(twist({1, 0, 0}));
    EXPECT_LT(toc.time, reach(0.01)) << under;
    EXPECT_GE(toc.time, reach(0.01 + stop) - 1e-6) << under;
  }
}

TEST(TimeOfContact, RestingSlidingAndSeparatingAreNotContactsAtOnce) {
  const std::array shapes{Shape::sphere(0.01), Shape::capsule(0.06, 0.01),
                          Shape::rounded_box({0.08, 0.09, 0.02}, 0.005)};
  for (const Shape& shape : shapes)
    for (const double gap : {2 * stop, stop, stop / 2, 1e-6, 1e-8}) {
      const double height = gap + shape.radius() + shape.half().z();
      const auto time = [&](const Vec3& linear, const Vec3& angular = Vec3::Zero()) {
        Duel s(shape, at({0.01, 0.02, height}), floor_sheet);
        return s.go(twist(linear, angular)).time;
      };
      EXPECT_EQ(time({0, 0, 0}), 1);
      EXPECT_EQ(time({0.05, 0.02, 0}), 1) << "sliding at " << gap;
      EXPECT_EQ(time({0.05, 0, 0.01}), 1) << "separating at " << gap;
      EXPECT_EQ(time({0, 0, 0.01}, {0, 0, 0.5}), 1) << "lifting and turning at " << gap;
      const double pressed = time({0.05, 0, -0.01});
      EXPECT_GT(pressed, 0) << "pressing at " << gap;
      EXPECT_LT(pressed * 0.01, gap) << "pressing at " << gap;
      // Tilting about the touching end: the other end goes up.
      EXPECT_TRUE(shape.core() != Core::segment || time({0, 0, 0.031}, {1.0, 0, 0}) > 0.5) << gap;
    }
}

TEST(TimeOfContact, PressingForeverNeverClosesTheGap) {
  Duel s(Shape::rounded_box({0.08, 0.09, 0.02}, 0.005), at({0, 0, 0.011}), floor_sheet);
  for (int frame = 0; frame < 100; ++frame) {
    const auto motion = twist({0.003, 0, -0.005}, {0.02, 0.01, 0.05});
    const TimeOfContact toc = s.go(motion);
    ASSERT_FALSE(toc.overlap) << frame;
    s.world.place(s.body, retract(s.world.pose(s.body), Vec<double, 6>(toc.time * motion)));
    ASSERT_GE(s.world.touches(0.01).size(), 1u);
    for (const Touch& t : s.world.touches(0.01)) ASSERT_GT(t.gap, 0) << frame;
  }
}

TEST(TimeOfContact, OverlapAtTheStartIsSaid) {
  Duel s(Shape::sphere(0.01), at({0, 0, 0.009}), floor_sheet);
  const TimeOfContact toc = s.go(twist({0, 0, 0.1}));
  EXPECT_TRUE(toc.overlap);
  EXPECT_EQ(toc.time, 0);
  EXPECT_LT(s.world.touches(0.001)[0].gap, 0);
}

// However deep, and however short the motion.
TEST(TimeOfContact, SaysADeepOverlap) {
  World world;
  world.add(std::make_shared<const Tree>(meshes::sheet(0.2, 0.2, 200)));
  world.add(Shape::capsule(0.04, 0.008), {Vec3(0.003, 0.001, 0.0004), Mat3::Identity()});
  for (const double length : {1e-9, 1e-3, 0.02}) {
    Move move{.collider = 1};
    move.twist.x() = length;
    const TimeOfContact toc = world.time_of_contact({&move, 1});
    EXPECT_TRUE(toc.overlap) << length;
    EXPECT_EQ(toc.time, 0) << length;
  }
}

TEST(TimeOfContact, TwoShapesBothMoving) {
  World world;
  const int a = world.add(Shape::capsule(0.05, 0.01), at({-0.1, 0, 0}));
  const int b = world.add(Shape::rounded_box({0.04, 0.04, 0.04}, 0.004), at({0.1, 0, 0}));
  const std::array<Move, 2> moves{Move{a, twist({0.3, 0, 0})}, Move{b, twist({-0.1, 0, 0})}};
  const TimeOfContact toc = world.time_of_contact(moves);
  EXPECT_LT(toc.time, 0.17 / 0.4);
  EXPECT_GE(toc.time, (0.17 - stop) / 0.4 - 1e-6);
  EXPECT_EQ(toc.a, a);
  EXPECT_EQ(toc.b, b);
  // Side by side at the same speed they never meet.
  const std::array<Move, 2> along{Move{a, twist({0.3, 0, 0})}, Move{b, twist({0.3, 0, 0})}};
  EXPECT_EQ(world.time_of_contact(along).time, 1);
}

TEST(TimeOfContact, PathsByTheirSpeedBound) {
  // A quarter circle about the origin, which crosses the plane x = 0.05 at 60 degrees... met earlier by the radius.
  const double r = 0.1, ball = 0.01;
  const Path path{.pose =
                      [r](double s) {
                        return at({r * std::sin(s * pi / 2), r - r * std::cos(s * pi / 2), 0});
                      },
                  .speed = r * pi / 2};
  World world;
  world.add(tree(meshes::sheet(1, 1, 200)), at({0.05, 0, 0}, {0, pi / 2, 0}));
  const int body = world.add(Shape::sphere(ball), path.pose(0));
  const Move move{.collider = body, .path = &path};
  const TimeOfContact toc = world.time_of_contact({&move, 1});
  const auto when = [&](double x) { return std::asin(x / r) / (pi / 2); };
  EXPECT_LT(toc.time, when(0.04));
  EXPECT_GE(toc.time, when(0.04 - stop) - 1e-6);

  // Sliding along the plane at a resting gap goes all the way.
  const Path slide{.pose = [](double s) { return at({0, 0.05 * s, 0}); }, .speed = 0.05};
  World plane;
  plane.add(tree(meshes::sheet(1, 1, 200)), at({2e-4 + ball, 0, 0}, {0, pi / 2, 0}));
  const int slider = plane.add(Shape::sphere(ball), at({0, 0, 0}));
  const Move along{.collider = slider, .path = &slide};
  EXPECT_EQ(plane.time_of_contact({&along, 1}).time, 1);
}

TEST(TimeOfContact, RandomMotionsAgainstDenseSampling) {
  Draw draw(4);
  const std::array bodies{
      Shape::sphere(0.012), Shape::capsule(0.06, 0.008), Shape::rounded_box({0.08, 0.05, 0.02}, 0.004),
      Shape::hull(std::array{Vec3(0.03, 0, 0), Vec3(-0.02, 0.02, 0), Vec3(0, -0.02, 0.01), Vec3(0, 0, 0.03)}, 0.003)};
  const auto mesh = tree(meshes::bumpy_sphere(0.05, 0.006, 5, 3000));
  int hits = 0;
  for (int i = 0; i < 600; ++i) {
    const Shape& shape = bodies[static_cast<std::size_t>(i % 4)];
    World world;
    const Pose<double> of_mesh = at(draw.cube(0.02), draw.cube(1));
    const int obstacle = world.add(mesh, of_mesh);
    const Vec3 from = 0.16 * draw.direction();
    const int body = world.add(shape, at(from, draw.cube(2)));
    const std::array<Move, 2> moves{
        Move{body, twist(-from + draw.cube(0.1), draw.cube(0.5))},
        Move{obstacle, i % 3 ? twist(draw.cube(0.03), draw.cube(0.5)) : twist(Vec3::Zero())}};
    const TimeOfContact toc = world.time_of_contact(moves);
    if (toc.overlap) continue;
    const Pose<double> start = world.pose(body);
    const auto gap = [&](double s) {
      world.place(body, retract(start, Vec<double, 6>(s * moves[0].twist)));
      world.place(obstacle, retract(of_mesh, Vec<double, 6>(s * moves[1].twist)));
      double least = 1;
      for (const Touch& t : world.touches(2 * stop)) least = std::min(least, t.gap);
      return least;
    };
    for (int k = 0; k <= 200; ++k) ASSERT_GT(gap(toc.time * k / 200), 0.49 * stop) << i << " at " << k;
    if (toc.time < 1) {
      ++hits;
      ASSERT_LE(gap(toc.time), stop + 1e-9) << i;
    }
  }
  EXPECT_GT(hits, 200);
}

}  // namespace
}  // namespace zwang::collision
