#include <gtest/gtest.h>
#include <Eigen/LU>

#include <fstream>
#include <numbers>
#include <sstream>

#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/distance.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>

#include "tests/folders.h"

namespace zwang {
namespace {

constexpr double pi = std::numbers::pi;

Pose<double> turned(const Vec3& w, const Vec3& position = Vec3::Zero()) {
  Vec<double, 6> twist;
  twist << position, w;
  return retract(Pose<double>{}, twist);
}

// Rows that hold together at a satisfied pose: 12 - rank freedoms, 6 of them the pair's own rigid motion.
template <class C>
int freedoms(const C& c, const Pose<double>& a, const Pose<double>& b) {
  EXPECT_LE(c.value(a, b).norm(), 1e-15) << C::name << " is not satisfied here";
  return 6 - static_cast<int>(Matrix(c.jacobian(a, b)).fullPivLu().rank());
}

TEST(Joints, LeaveTheFreedomsTheyAreNamedFor) {
  const Pose<double> a = turned({0.1, 0.2, -0.3}, {1, 2, 3}), b = a;
  const std::array<BodyId, 2> ab{0, 1};
  const Vec3 p{1, 2, 3}, x = Vec3::UnitX(), y = Vec3::UnitY();
  EXPECT_EQ(freedoms(BallJoint{ab, p, p}, a, b), 3);
  EXPECT_EQ(freedoms(UniversalJoint{ab, p, p, x, y}, a, b), 2);
  EXPECT_EQ(freedoms(RevoluteJoint{ab, p, p, x, x}, a, b), 1);
  EXPECT_EQ(freedoms(PrismaticJoint{ab, p, p, x}, a, b), 1);
  EXPECT_EQ(freedoms(Weld{ab, p, p}, a, b), 0);
}

TEST(Joints, AHingeTurnsAndASliderSlidesWithoutViolation) {
  const Vec3 anchor{0.5, 0.25, 1}, axis = Vec3::UnitZ();
  const RevoluteJoint hinge{{0, 1}, anchor, Vec3::Zero(), axis, axis};
  const PrismaticJoint slider{{0, 1}, Vec3::Zero(), anchor, axis};
  for (const double s : {-2., 0.1, 1., 3.}) {
    EXPECT_LE(hinge.value({}, turned(s * axis, anchor)).norm(), 1e-15);
    EXPECT_LE(slider.value(turned(Vec3::Zero(), anchor + s * axis), {}).norm(), 1e-15);
  }
  EXPECT_GT(hinge.value({}, turned({0.1, 0, 0}, anchor)).norm(), 0.09);
  EXPECT_GT(slider.value(turned(Vec3::Zero(), anchor + Vec3(0.1, 0, 0)), {}).norm(), 0.09);
}

TEST(JointLimit, ValueIsTheAngleLeftBeforeTheBoundOnEitherSide) {
  const JointLimit lower{.bodies = {0, 1}, .bound = -0.25, .side = Side::lower};
  const JointLimit upper{.bodies = {0, 1}, .bound = 1.5, .side = Side::upper};
  for (const double angle : {-0.5, 0., 1., 2.}) {
    const Pose<double> a = turned({0.3, 0.2, 0.1}), b{Vec3::Zero(), a.rotation * turned({angle, 0, 0}).rotation};
    EXPECT_NEAR(lower.value(a, b)[0], angle + 0.25, 1e-15);
    EXPECT_NEAR(upper.value(a, b)[0], 1.5 - angle, 1e-15);
    EXPECT_EQ(lower.active(a, b), angle < -0.25);
    EXPECT_EQ(upper.active(a, b), angle > 1.5);
  }
}

TEST(JointLimit, StaysContinuousHalfATurnAwayFromZero) {
  const JointLimit upper{.bodies = {0, 1}, .bound = pi - 0.05, .side = Side::upper};
  EXPECT_NEAR(upper.value({}, turned({pi + 0.05, 0, 0}))[0], -0.1, 1e-15);
}

TEST(JointLimit, AtTheAxisTheRowTurnsAboutTheAxis) {
  const JointLimit limit{.bodies = {0, 1}, .direction = Vec3::UnitX()};
  const auto J = limit.jacobian({}, {});
  EXPECT_EQ(J.rightCols(3), Vec3::UnitX().transpose());
  EXPECT_EQ(J.middleCols(3, 3), -Vec3::UnitX().transpose());
}

TEST(Rope, WithCoincidentAnchorsTheRowIsTheLimitAlongTheXAxisOfB) {
  const Rope rope{{.bodies = {0, 1}, .length = 1.5}};
  const Pose<double> b = turned({0, 0, pi / 2});
  EXPECT_EQ(rope.value({}, b)[0], 1.5);
  const double h = 0x1p-20;
  Pose<double> near;
  near.position = h * b.rotation.col(0);
  EXPECT_LE((rope.jacobian({}, b) - rope.jacobian(near, b)).norm(), 1e-15);
  EXPECT_NEAR((rope.value(near, b)[0] - rope.value({}, b)[0]) / h, -1, 1e-9);
}

TEST(Contact, GapIsCountedAlongTheNormalFromBToA) {
  std::vector<Body> bodies(2);
  bodies[0].pose = turned({0.1, -0.4, 0.2}, {0, 0, 2});
  bodies[1].pose = turned({0.7, 0.3, 0}, {0, 1, -1});
  const Vec3 n = Vec3(1, 2, 2) / 3;
  const Contact contact = contact_at(bodies, 0, 1, {0.1, 0.2, 0.3}, n, 0.25, 0.5);
  EXPECT_NEAR(contact.value(bodies[0].pose, bodies[1].pose)[0], 0.25, 1e-15);
  bodies[0].pose.position += 0.5 * n;
  EXPECT_NEAR(contact.value(bodies[0].pose, bodies[1].pose)[0], 0.75, 1e-15) << "A moved away";
  EXPECT_NEAR((contact.frame.transpose() * contact.frame - Mat3::Identity()).norm(), 0, 1e-15);
}

TEST(Guide, TheConstraintOfTheGuideHasAtMostFifteenLines) {
  std::ifstream guide(source_dir() / "docs/add-a-constraint.md");
  ASSERT_TRUE(guide.is_open());
  int lines = 0;
  bool inside = false;
  for (std::string text; std::getline(guide, text);) {
    inside = inside || text.starts_with("struct ");
    lines += inside && !text.empty();
    if (text == "};") inside = false;
  }
  EXPECT_GT(lines, 5);
  EXPECT_LE(lines, 15);
}

}  // namespace
}  // namespace zwang
