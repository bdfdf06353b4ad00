#include <zwang/experiments/god_hand/step/physics.h>

#include <gtest/gtest.h>

#include <zwang/bench/collision/meshes.h>
#include "tests/god_hand/loose_box.h"

namespace zwang::god {
namespace {

constexpr double dt = 1e-3;

Surroundings stack() {
  Surroundings s;
  s.objects = {fixed_block({0, 0, -0.01}, {0.5, 0.5, 0.02}),
               loose_box({0, 0, 0.03}),
               loose_box({0.01, 0, 0.09}),
               {.name = "ball",
                .pieces = {{collision::Shape::sphere(0.02)}},
                .pose = {{0.1, 0.1, 0.05}, Mat3::Identity()},
                .mass = 0.1,
                .inertia = 1.6e-5 * Mat3::Identity()}};
  return s;
}

std::vector<double> state(const Physics& physics, std::size_t objects) {
  std::vector<double> all;
  for (std::size_t k = 0; k < objects; ++k) {
    const Pose<double> pose = physics.pose(k);
    const Vec<double, 6> v = physics.velocity(k);
    all.insert(all.end(), pose.position.begin(), pose.position.end());
    all.insert(all.end(), pose.rotation.reshaped().begin(), pose.rotation.reshaped().end());
    all.insert(all.end(), v.begin(), v.end());
  }
  return all;
}

std::vector<Vec<double, 6>> push(const Vec3& force) {
  std::vector<Vec<double, 6>> wrench(4, Vec<double, 6>::Zero());
  wrench[1].head<3>() = force;
  wrench[1][5] = 0.002;
  return wrench;
}

TEST(Physics, AWrenchActsForOneStep) {
  Surroundings s{.objects = {loose_box({0, 0, 0})}, .gravity = Vec3::Zero()};
  Physics physics(s);
  Vec<double, 6> wrench;
  wrench << 2, 0, 0, 0, 0, 0.001;
  physics.step(dt, {&wrench, 1});
  physics.step(dt, {});
  const Vec<double, 6> v = physics.velocity(0);
  EXPECT_NEAR(v[0], 2 / 0.2 * dt, 1e-15);
  EXPECT_NEAR(v[5], 0.001 / (0.2 * 0.06 * 0.06 / 6) * dt, 1e-9);
  EXPECT_NEAR(physics.pose(0).position.x(), 2 * v[0] * dt, 1e-15);
}

TEST(Physics, AStackRests) {
  Physics physics(stack());
  for (int k = 0; k < 1000; ++k) physics.step(dt, {});
  EXPECT_NEAR(physics.pose(1).position.z(), 0.03, 2e-4);
  EXPECT_NEAR(physics.pose(2).position.z(), 0.09, 4e-4);
  EXPECT_NEAR(physics.pose(2).position.x(), 0.01, 1e-4);
  EXPECT_NEAR(physics.pose(3).position.z(), 0.02, 2e-4);
  EXPECT_LT(physics.velocity(2).norm(), 1e-3);
}

TEST(Physics, WhatRestsMovesWhenPushed) {
  Physics physics(stack());
  for (int k = 0; k < 3000; ++k) physics.step(dt, {});
  const double before = physics.pose(1).position.x();
  for (int k = 0; k < 100; ++k) physics.step(dt, push({6, 0, 0}));
  EXPECT_GT(physics.pose(1).position.x(), before + 0.005);
}

// The mean of the two frictions, 0.5, holds a box of 0.2 kg against 0.9 N and not against 1.1 N.
TEST(Physics, FrictionIsThatOfThePair) {
  for (const double share : {0.9, 1.1}) {
    Surroundings s = stack();
    s.objects.pop_back();
    s.objects.pop_back();
    Physics physics(s);
    std::vector<Vec<double, 6>> wrench(2, Vec<double, 6>::Zero());
    wrench[1][0] = share * 0.5 * 0.2 * 9.81;
    for (int k = 0; k < 500; ++k) physics.step(dt, wrench);
    EXPECT_EQ(physics.pose(1).position.x() > 0.01, share > 1) << physics.pose(1).position.x();
  }
}

TEST(Physics, SameCallsSameBits) {
  Physics a(stack()), b(stack());
  for (int k = 0; k < 500; ++k) {
    a.step(dt, push({3, 1, 0}));
    b.step(dt, push({3, 1, 0}));
  }
  EXPECT_EQ(state(a, 4), state(b, 4));
}

TEST(Physics, ARestoredWorldGoesOnBitForBit) {
  Physics a(stack());
  for (int k = 0; k < 300; ++k) a.step(dt, push({3, 1, 0}));
  a.forget();
  Physics b(stack());
  for (std::size_t k = 0; k < 4; ++k) b.place(k, a.pose(k), a.velocity(k));
  b.forget();
  EXPECT_EQ(state(a, 4), state(b, 4));
  for (int k = 0; k < 500; ++k) {
    a.step(dt, push({3, 1, 0}));
    b.step(dt, push({3, 1, 0}));
  }
  EXPECT_EQ(state(a, 4), state(b, 4));
}

TEST(Physics, WhatFallsOnAMeshStays) {
  Surroundings s;
  s.objects = {{.name = "sheet", .mesh = std::make_shared<const collision::Tree>(meshes::sheet(0.4, 0.4, 5000))},
               loose_box({0, 0, 0.04})};
  Physics physics(s);
  for (int k = 0; k < 1000; ++k) physics.step(dt, {});
  EXPECT_NEAR(physics.pose(1).position.z(), 0.03, 5e-4);
  const Vec3 settled = physics.pose(1).position;
  for (int k = 0; k < 1000; ++k) physics.step(dt, {});
  EXPECT_LT((physics.pose(1).position - settled).norm(), 2e-4);
}

TEST(Physics, WhatIsFastDoesNotTunnelThroughASheet) {
  Surroundings s;
  s.objects = {{.name = "sheet", .mesh = std::make_shared<const collision::Tree>(meshes::sheet(0.4, 0.4, 5000))},
               loose_box({0, 0, 0.1})};
  Physics physics(s);
  Vec<double, 6> v = Vec<double, 6>::Zero();
  v[2] = -100;
  physics.place(1, physics.pose(1), v);
  for (int k = 0; k < 300; ++k) physics.step(dt, {});
  EXPECT_GT(physics.pose(1).position.z(), 0);
}

TEST(Physics, SaysWhatItCannotUse) {
  Surroundings s{.objects = {loose_box({0, 0, 0})}};
  s.objects[0].inertia(0, 1) = s.objects[0].inertia(1, 0) = 1e-5;
  EXPECT_THROW(Physics{s}, std::invalid_argument);
  s.objects = {{.name = "nothing"}};
  EXPECT_THROW(Physics{s}, std::invalid_argument);
}

}  // namespace
}  // namespace zwang::god
