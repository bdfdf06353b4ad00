#include <zwang/experiments/god_hand/step/resolution.h>

#include <gtest/gtest.h>

#include <numbers>

#include "tests/god_hand/loose_box.h"

namespace zwang::god {
namespace {

using collision::Shape;
using std::numbers::pi;

const Shape finger = Shape::capsule(0.1, 0.008);  // along y

Pose<double> posed(double x, double z) { return {{x, 0, z}, Mat3::Identity()}; }

struct Bench {
  Surroundings surroundings;
  std::vector<Shape> shapes;
  std::vector<Pose<double>> gods;
  std::vector<Pose<double>> before;
  Physics physics;
  Resolution resolution;

  Bench(std::vector<Object> objects, const std::vector<Pose<double>>& fingers)
      : surroundings{.objects = std::move(objects), .gravity = Vec3::Zero()},
        shapes(fingers.size(), finger),
        gods(fingers),
        physics(surroundings),
        resolution(surroundings, shapes) {
    for (const Object& object : surroundings.objects) before.push_back(object.pose);
  }
  // As if the engine's step had taken it there.
  void move(std::size_t object, const Vec3& to, const Vec3& velocity) {
    Vec<double, 6> v;
    v << velocity, 0, 0, 0;
    physics.place(object, {to, physics.pose(object).rotation}, v);
  }
  Resolved resolve() { return resolution.resolve(physics, before, gods); }

  // The smallest gap of a loose object to a finger, and to anything else.
  std::pair<double, double> gaps() const {
    collision::World world;
    for (std::size_t g = 0; g < gods.size(); ++g) world.add(shapes[g], gods[g], {1, ~std::uint64_t{1}}, true);
    std::uint64_t bit = 2;
    for (std::size_t k = 0; k < surroundings.objects.size(); ++k, bit *= 2)
      world.add(surroundings.objects[k].pieces[0].shape, physics.pose(k), {bit, ~bit},
                !surroundings.objects[k].loose());
    double hand = 1, other = 1;
    for (const collision::Touch& t : world.touches(0.01)) {
      double& gap = t.a < static_cast<int>(gods.size()) ? hand : other;
      gap = std::min(gap, t.gap);
    }
    return {hand, other};
  }
};

TEST(Resolution, WhatIsClearStaysAsItIs) {
  Bench bench({loose_box({0, 0, 0.03})}, {posed(0, -0.02)});
  bench.move(0, {0.001, 0, 0.03}, {1, 0, -1});
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.overlapping + r.rounds + r.returned + r.swept, 0);
  EXPECT_EQ(bench.physics.pose(0).position, Vec3(0.001, 0, 0.03));
  EXPECT_EQ(bench.physics.velocity(0)[2], -1);
}

TEST(Resolution, ABoxIsPushedOutOfAFingerAndFallsInNoMore) {
  Bench bench({loose_box({0, 0, 0.03})}, {posed(0.01, -0.0081)});
  bench.move(0, {0, 0, 0.0285}, {0.2, 0, -1.5});
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.overlapping, 1);
  EXPECT_EQ(r.returned, 0);
  EXPECT_NEAR(r.deepest, 0.0014, 1e-9);
  EXPECT_GE(bench.gaps().first, 2e-5);
  EXPECT_LT(bench.gaps().first, 3e-4);
  EXPECT_LT((bench.physics.pose(0).position - Vec3(0, 0, 0.03)).norm(), 0.002);
  // Sliding along stays; the contact goes apart or stands; energy is not made.
  const Vec<double, 6> v = bench.physics.velocity(0);
  EXPECT_NEAR(v[0], 0.2, 0.03);
  collision::World world;
  world.add(finger, bench.gods[0]);
  world.add(bench.surroundings.objects[0].pieces[0].shape, bench.physics.pose(0));
  const auto touches = world.touches(1e-3);
  ASSERT_FALSE(touches.empty());
  for (const collision::Touch& t : touches) {
    const Vec3 arm = t.point_b - bench.physics.pose(0).position;
    EXPECT_LE(t.normal.dot(v.head<3>() + Vec3(v.tail<3>()).cross(arm)), 1e-6);
  }
  EXPECT_LT(v.head<3>().squaredNorm() * 0.1 + v.tail<3>().squaredNorm() * 0.5 * 0.2 * 0.0036 / 6, 0.1 * (0.04 + 2.25));
}

// Two fingers 0.5 mm nearer to each other than the box is high, and it was driven in between.
TEST(Resolution, WedgedBetweenTwoFingersItGoesBack) {
  Bench bench({loose_box({0.0333, 0, 0.03})}, {posed(0, -0.00775), posed(0, 0.06775)});
  bench.move(0, {0.0295, 0, 0.03}, {-3.8, 0, 0});
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.returned, 1);
  EXPECT_EQ(bench.physics.pose(0).position, bench.before[0].position);
  EXPECT_EQ(bench.physics.velocity(0).norm(), 0);
  EXPECT_GE(bench.gaps().first, 2e-5);
}

TEST(Resolution, AStackIsMovedAsOne) {
  Bench bench({loose_box({0, 0, 0.03}), loose_box({0, 0, 0.09})}, {posed(0.012, -0.0081), posed(-0.012, -0.0081)});
  bench.move(0, {0, 0, 0.0285}, {0, 0, -1});
  bench.move(1, {0, 0, 0.0885}, {0, 0, -1});
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.overlapping, 1);
  EXPECT_EQ(r.returned, 0);
  EXPECT_GE(bench.gaps().first, 2e-5);
  EXPECT_GE(bench.gaps().second, -5e-4);
  EXPECT_GT(bench.physics.pose(1).position.z(), 0.0892);
}

TEST(Resolution, ItIsNotPushedDeepIntoABlock) {
  Bench roomy({loose_box({0, 0, 0.03}), fixed_block({0, 0, 0.0706}, {0.2, 0.2, 0.02})}, {posed(0, -0.0081)});
  roomy.move(0, {0, 0, 0.0285}, {0, 0, -1});
  EXPECT_EQ(roomy.resolve().returned, 0);
  EXPECT_GE(roomy.gaps().second, -5e-4);
  Bench tight({loose_box({0.0333, 0, 0.03}), fixed_block({0, 0, 0.07}, {0.2, 0.2, 0.02})}, {posed(0, -0.00675)});
  tight.move(0, {0.0295, 0, 0.03}, {-3.8, 0, 0});
  const Resolved r = tight.resolve();
  EXPECT_EQ(r.returned, 1);
  EXPECT_EQ(tight.physics.pose(0).position, tight.before[0].position);
}

TEST(Resolution, WhatLiesWhereAnotherGoesBackToGoesBackToo) {
  Bench bench({loose_box({0.0333, 0, 0.03}), loose_box({0.0935, 0, 0.03})}, {posed(0, -0.00775), posed(0, 0.06775)});
  bench.move(0, {0.0295, 0, 0.03}, {-3.8, 0, 0});
  bench.move(1, {0.0896, 0, 0.03}, {-3.8, 0, 0});
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.returned, 2);
  EXPECT_EQ(bench.physics.pose(1).position, bench.before[1].position);
}

TEST(Resolution, NothingJumpsOverAFinger) {
  for (const double speed : {10., 40., 200.}) {
    Bench bench({loose_box({0, 0, 0.05}, 0.02)}, {posed(0, 0)});
    bench.move(0, {0, 0, 0.05 - speed * 1e-3}, {0, 0, -speed});
    const Resolved r = bench.resolve();
    EXPECT_GT(bench.physics.pose(0).position.z(), 0.0179) << speed;
    EXPECT_EQ(r.swept, speed > 32);
    EXPECT_GE(bench.gaps().first, 2e-5);
    if (r.swept) {
      EXPECT_GE(bench.physics.velocity(0)[2], -1e-6);
    }
  }
}

// Loose objects made of pieces turn about their centre of mass on the way.
TEST(Resolution, ATurningBarIsStoppedOnItsWay) {
  Object bar{.name = "bar",
             .pieces = {{Shape::capsule(0.1, 0.005), {{0, 0.06, 0}, Mat3::Identity()}},
                        {Shape::capsule(0.1, 0.005), {{0, -0.06, 0}, Mat3::Identity()}}},
             .pose = {{0, 0.1, 0}, Mat3::Identity()},
             .mass = 0.1,
             .inertia = 1e-4 * Mat3::Identity()};
  Mat3 upright;
  upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  Bench bench({bar}, {{{0.05, 0.18, 0}, upright}});
  const double angle = -pi / 2;
  Mat3 turned;
  turned << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  bench.physics.place(0, {{0, 0.1, 0}, turned}, Vec<double, 6>::Zero());
  const Resolved r = bench.resolve();
  EXPECT_EQ(r.swept, 1);
  // At 0.094 m from the middle, less the two radii, 0.5 rad to the side.
  const double reached = -rotation_vector<double>(bench.physics.pose(0).rotation).z();
  EXPECT_NEAR(reached, std::atan2(0.05, 0.08) - std::asin(0.013 / std::hypot(0.05, 0.08)), 2e-3);
}

TEST(Resolution, SameCallsSameBits) {
  const auto run = [] {
    Bench bench({loose_box({0, 0, 0.03}), loose_box({0, 0, 0.09})}, {posed(0.02, -0.0081), posed(-0.012, -0.0081)});
    for (int k = 0; k < 50; ++k) {
      for (std::size_t o = 0; o < 2; ++o) bench.before[o] = bench.physics.pose(o);
      bench.physics.step(1e-3, {});
      for (std::size_t o = 0; o < 2; ++o) {
        Vec<double, 6> v = bench.physics.velocity(o);
        v[2] -= 0.01;
        bench.physics.place(o, bench.physics.pose(o), v);
      }
      bench.resolve();
      EXPECT_GE(bench.gaps().first, 2e-5);
    }
    return bench.physics.pose(1);
  };
  const Pose<double> a = run(), b = run();
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.rotation, b.rotation);
}

}  // namespace
}  // namespace zwang::god
