#include <zwang/core/model/motion.h>

#include <gtest/gtest.h>

#include <numbers>

namespace zwang {
namespace {

constexpr double pi = std::numbers::pi;

Pose<double> random_pose() { return retract<double>({}, Vec<double, 6>::Random() * 1.5); }

TEST(Pose, TwistBetweenTwoPosesTakesOneToTheOther) {
  std::srand(1);
  for (int k = 0; k < 100; ++k) {
    const Pose<double> a = random_pose(), b = random_pose();
    const Pose<double> reached = retract(a, twist_between(a, b));
    EXPECT_LE((reached.rotation - b.rotation).norm(), 4e-15);
    EXPECT_LE((reached.position - b.position).norm(), 4e-16);
  }
}

TEST(Pose, RotationVectorIsAccurateFromTinyAnglesToHalfATurn) {
  std::srand(1);
  for (const double angle : {0., 1e-300, 1e-12, 1e-3, 2e-3, 0.5, 1.7, 3., pi - 1e-3, pi - 1e-9, pi})
    for (int k = 0; k < 20; ++k) {
      const Vec3 w = angle * (k < 3 ? Vec3(Vec3::Unit(k)) : Vec3(Vec3::Random().normalized()));
      Vec<double, 6> twist;
      twist << Vec3::Zero(), w;
      const Vec3 found = rotation_vector<double>(retract<double>({}, twist).rotation);
      const double error = std::min((found - w).norm(), angle > 3.1 ? (found + w).norm() : 1);  // half a turn: +-w
      EXPECT_LE(error, 4e-16 * std::max(angle, 1.)) << angle << ": " << found.transpose() << " for " << w.transpose();
      if (angle < 0.1) {
        EXPECT_LE(error, 4e-16 * angle) << angle;
      }
    }
}

TEST(Motion, OneFreeStepWithReachingStiffnessReachesTheTargets) {
  std::srand(1);
  const double dt = 0x1p-7;
  Scene scene;
  std::vector<Pose<double>> target;
  for (const Motion motion : {Motion::free, Motion::fixed, Motion::free}) {
    scene.add(Body{.pose = random_pose(), .motion = motion});
    target.push_back(random_pose());
  }
  const Pose<double> fixed = scene.bodies[1].pose;
  Vector z_u;
  couple_to_targets(scene, target, reaching_stiffness(dt), z_u);
  ASSERT_EQ(z_u.size(), 12);
  integrate(scene, z_u, dt, Mode::quasi_static);
  for (const std::size_t b : {0u, 2u}) {
    EXPECT_LE((scene.bodies[b].pose.position - target[b].position).norm(), 1e-15);
    EXPECT_LE((scene.bodies[b].pose.rotation - target[b].rotation).norm(), 4e-15);
  }
  EXPECT_EQ(scene.bodies[1].pose.position, fixed.position);
}

TEST(Motion, AFreeBodyFallsAndKeepsItsAngularMomentum) {
  Scene scene;
  scene.add(Body{.pose = random_pose(), .mass = 2, .inertia = Vec3(1, 2, 2.5).asDiagonal()});
  Body& body = scene.bodies[0];
  body.velocity << 0, 0, 0, 1, 0.3, -2;
  Vector z_u;
  move_freely(scene, {0, 0, -10}, {}, z_u);
  EXPECT_EQ(z_u.head<3>(), Vec3(0, 0, -10));
  // d/dt (I_world w) = I_world z + w x I_world w = 0.
  const Mat3 inertia = body.pose.rotation * body.inertia * body.pose.rotation.transpose();
  const Vec3 w = body.velocity.tail<3>();
  EXPECT_LE((inertia * z_u.tail<3>() + w.cross(inertia * w)).norm(), 1e-14);
}

TEST(Motion, AWrenchActsThroughMassAndWorldInertia) {
  Scene scene;
  scene.add(Body{.mass = 4, .inertia = Vec3(1, 2, 4).asDiagonal()});
  scene.bodies[0].pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // body x is world y
  Vec<double, 6> wrench;
  wrench << 4, 8, 0, 2, 3, 4;
  Vector z_u, expected(6);
  move_freely(scene, Vec3::Zero(), std::span(&wrench, 1), z_u);
  expected << 1, 2, 0, 1, 3, 1;
  EXPECT_LE((z_u - expected).norm(), 1e-15);
}

TEST(Motion, SymplecticEulerMovesWithTheNewVelocity) {
  Scene scene;
  scene.add(Body{});
  scene.bodies[0].velocity << 1, 0, 0, 0, 0, 0;
  Vector z = Vector::Zero(6);
  z << 0, 2, 0, 0, 0, 0;
  integrate(scene, z, 0.5, Mode::dynamic);
  EXPECT_EQ(scene.bodies[0].pose.position, Vec3(0.5, 0.5, 0));
  EXPECT_EQ(scene.bodies[0].velocity.head<3>(), Vec3(1, 1, 0));
}

// Gap 4 of docs/formulation.md: a body 1 m from a wall that wants to go 2 m is stopped at half of its path, at the
// wall.
TEST(Motion, TimeOfContactScalesThePathOnce) {
  Scene scene;
  scene.add(Body{});
  Vector z = Vector::Zero(6);
  z[0] = 8;
  integrate(scene, z, 0.5, Mode::quasi_static, 0.5);
  EXPECT_EQ(scene.bodies[0].pose.position, Vec3(1, 0, 0));
  EXPECT_TRUE(scene.bodies[0].velocity.isZero(0));
}

TEST(Motion, EachBodyMayStopAtItsOwnTimeOfContact) {
  Scene scene;
  for (const Motion motion : {Motion::free, Motion::prescribed, Motion::free}) scene.add(Body{.motion = motion});
  scene.bodies[1].prescribed[2] = 4;
  const Vector z = Vector::Ones(12);
  const std::array<double, 3> toc{1, 0.5, 0.25};
  integrate(scene, z, 1, Mode::quasi_static, toc);
  EXPECT_EQ(scene.bodies[0].pose.position, Vec3(1, 1, 1));
  EXPECT_EQ(scene.bodies[1].pose.position, Vec3(0, 0, 2));
  EXPECT_EQ(scene.bodies[2].pose.position, Vec3(0.25, 0.25, 0.25));
}

TEST(Motion, WrongSizesThrow) {
  Scene scene;
  scene.add(Body{});
  Vector z_u = Vector::Zero(3);
  EXPECT_THROW(integrate(scene, z_u, 1, Mode::dynamic), std::invalid_argument);
  EXPECT_THROW(couple_to_targets(scene, {}, 1, z_u), std::invalid_argument);
  EXPECT_THROW(move_freely(scene, Vec3::Zero(), std::vector<Vec<double, 6>>(2), z_u), std::invalid_argument);
}

}  // namespace
}  // namespace zwang
