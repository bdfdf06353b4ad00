#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include <zwang/collision/world.h>

namespace zwang::collision {
namespace {

std::vector<Touch> touches(const Shape& a, const Pose<double>& at_a, const Shape& b, const Pose<double>& at_b,
                           double activation) {
  World world;
  world.add(a, at_a);
  world.add(b, at_b);
  const auto found = world.touches(activation);
  return {found.begin(), found.end()};
}

Pose<double> at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return retract<double>({{x, y, z}, Mat3::Identity()}, (Vec<double, 6>() << 0, 0, 0, turn).finished());
}

const Shape cube = Shape::rounded_box({0.1, 0.1, 0.1}, 0.002), finger = Shape::capsule(0.06, 0.008);  // along y

// Does some touch lie within 0.1 mm of (x, y)?
bool over(const std::vector<Touch>& found, double x, double y) {
  return std::any_of(found.begin(), found.end(),
                     [&](const Touch& t) { return std::hypot(t.point_a.x() - x, t.point_a.y() - y) < 1e-4; });
}

TEST(FaceContacts, ABoxOnABoxIsHeldAtTheCornersOfTheirCommonArea) {
  const auto found = touches(cube, at(0.03, 0.01, 0.1005), cube, at(0, 0, 0), 1e-3);
  EXPECT_GE(found.size(), 4u);
  for (const double x : {-0.018, 0.048})
    for (const double y : {-0.038, 0.048}) EXPECT_TRUE(over(found, x, y)) << x << ' ' << y;
  for (const Touch& t : found) {
    EXPECT_NEAR(t.gap, 5e-4, 1e-9);
    EXPECT_NEAR(t.normal.z(), 1, 1e-9);
  }
}

TEST(FaceContacts, AFingerOnABoxIsHeldAtBothEnds) {
  for (const bool first : {true, false}) {
    const auto found = first ? touches(finger, at(0.02, 0, 0.0585), cube, at(0, 0, 0), 1e-3)
                             : touches(cube, at(0, 0, 0), finger, at(0.02, 0, 0.0585), 1e-3);
    EXPECT_TRUE(over(found, 0.02, -0.03) && over(found, 0.02, 0.03)) << first;
  }
}

TEST(FaceContacts, AFingerAcrossABarIsHeldAtItsEdges) {
  const Shape bar = Shape::rounded_box({0.2, 0.02, 0.02}, 0.002);
  const auto found = touches(finger, at(0.02, 0, 0.0185), bar, at(0, 0, 0), 1e-3);
  EXPECT_TRUE(over(found, 0.02, -0.008) && over(found, 0.02, 0.008));
}

TEST(FaceContacts, FingersSideBySide) {
  const auto found = touches(finger, at(0, 0, 0), finger, at(0.0165, 0.02, 0), 1e-3);
  EXPECT_TRUE(over(found, 0.008, -0.01) && over(found, 0.008, 0.03));
}

TEST(FaceContacts, WherePointsMeetSidesOrEdgesCrossOnePairIsAll) {
  EXPECT_EQ(touches(Shape::sphere(0.01), at(0, 0, 0.0605), cube, at(0, 0, 0), 1e-3).size(), 1u);
  EXPECT_EQ(touches(finger, at(0, 0, 0.0165), finger, at(0, 0, 0, {0, 0, 1.5}), 1e-3).size(), 1u);
  EXPECT_EQ(touches(finger, at(0, 0, 0.08, {0.5, 0, 0}), cube, at(0, 0, 0), 2e-2).size(), 1u);
}

// Anywhere: points lie on the surfaces, as far apart as the gap says, along the normal, none nearer than the first.
TEST(FaceContacts, EveryPairIsExact) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> draw(-1, 1);
  const auto cube_of = [&](double h) { return Vec3(h * draw(random), h * draw(random), h * draw(random)); };
  int more = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<Vec3> cloud;
    for (int k = 0; k < 12; ++k) cloud.push_back(cube_of(0.03));
    const Shape some[] = {Shape::rounded_box({0.06, 0.04, 0.05}, 0.003), finger, Shape::hull(cloud, 0.002)};
    const Shape &a = some[trial % 3], &b = some[trial / 3 % 3];
    const double flat = trial % 2 ? 0.03 : 1.5;
    const Pose<double> at_a =
        retract<double>({cube_of(0.06), Mat3::Identity()}, (Vec<double, 6>() << 0, 0, 0, cube_of(flat)).finished());
    const auto found = touches(a, at_a, b, {}, 4e-3);
    if (found.empty() || found[0].gap <= 0) continue;
    more += found.size() > 1;
    EXPECT_LE(found.size(), 7u);
    for (const Touch& t : found) {
      EXPECT_GE(t.gap, found[0].gap - 1e-12);
      EXPECT_LE(t.gap, 4e-3);
      EXPECT_NEAR(t.normal.norm(), 1, 1e-12);
      EXPECT_NEAR((t.point_b + t.gap * t.normal - t.point_a).norm(), 0, 1e-12);
      const Vec3 of_a = t.point_a + a.radius() * t.normal, of_b = t.point_b - b.radius() * t.normal;  // of the cores
      const Shape dot = Shape::sphere(1e-9);
      for (const auto& [shape, place, p] : {std::tuple(&a, at_a, of_a), {&b, Pose<double>{}, of_b}}) {
        const auto none = touches(dot, {p, Mat3::Identity()}, *shape, place, 1);
        EXPECT_NEAR(none.at(0).gap + shape->radius(), 0, 1e-8);
      }
    }
  }
  EXPECT_GT(more, 300);
}

}  // namespace
}  // namespace zwang::collision
