#include <zwang/experiments/god_hand/measure/disturbance.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace zwang::god {
namespace {

// Two fingers press a box from both sides along x, at the height of its centre, with P = 5 N each. That nothing turns
// they carry the same across, (F_y, F_z) / 2, for which both need |(F_y, F_z)| / (2 mu), and one of them |F_x| more;
// together they have 2 P.
double closed_form(double weight, double mu) {
  double least = 1e300;
  for (int k = 0; k < 27; ++k) {
    Vec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (d.isZero(0)) continue;
    d.normalize();
    double low = 0, high = 100;
    for (int halving = 0; halving < 80; ++halving) {
      const double r = (low + high) / 2;
      (std::hypot(r * d.y(), r * d.z() - weight) / mu + r * std::abs(d.x()) <= 10 ? low : high) = r;
    }
    least = std::min(least, low);
  }
  return least;
}

TEST(Disturbance, OfTwoOpposedFingersIsWhatFrictionLeavesOfTheWeight) {
  const std::array<Holding, 2> fingers = {Holding{{-0.03, 0, 0}, {1, 0, 0}, 5}, Holding{{0.03, 0, 0}, {-1, 0, 0}, 5}};
  for (const double mu : {0.3, 0.5, 0.8})
    for (const double weight : {0.0, 1.0, 2.0})
      EXPECT_NEAR(largest_disturbance(fingers, {0, 0, -weight}, mu), closed_form(weight, mu), 1e-6)
          << mu << ' ' << weight;
  // Where friction is small, straight down is the worst: 2 mu P less the weight.
  EXPECT_NEAR(largest_disturbance(fingers, {0, 0, -1}, 0.3), 2 * 0.3 * 5 - 1, 1e-7);
  EXPECT_EQ(largest_disturbance(fingers, {0, 0, -3.1}, 0.3), 0);  // more than they hold
}

// Above the centre of mass they hold the weight, which hangs below them, but no force beside it across the line through
// both: that would turn the box about it.
TEST(Disturbance, NothingHoldsAgainstATurnAboutTheLineThroughTwoPoints) {
  const std::array<Holding, 2> fingers = {Holding{{-0.03, 0, 0.01}, {1, 0, 0}, 5},
                                          Holding{{0.03, 0, 0.01}, {-1, 0, 0}, 5}};
  EXPECT_NEAR(largest_disturbance(fingers, {0, 0, -1}, 0.8), 0, 1e-7);
}

// Without friction, six fingers on the sides of a cube, 1 N each: a force toward a side has all six newtons against it,
// one toward a corner needs sqrt(3) times itself.
TEST(Disturbance, WithoutFrictionItIsAMatterOfNormals) {
  std::vector<Holding> fingers;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      fingers.push_back({0.02 * side * Vec3::Unit(axis), -side * Vec3::Unit(axis), 1});
  EXPECT_NEAR(largest_disturbance(fingers, Vec3::Zero(), 0), 6 / std::sqrt(3.0), 1e-7);
}

TEST(Disturbance, NothingIsHeldByNothing) { EXPECT_EQ(largest_disturbance({}, {0, 0, -1}, 0.8), 0); }

TEST(Disturbance, IsOfTheObjectThatIsPressedHardest) {
  Surroundings s;
  for (const double mass : {0.0, 0.1, 0.2}) s.objects.push_back({.name = "box", .mass = mass});
  Frame frame;
  frame.loose = {{{1, 0, 0}, Mat3::Identity()}, {{2, 0, 0}, Mat3::Identity()}};
  frame.contacts = {{.object = 0, .normal = Vec3::UnitX(), .push = 9},
                    {.object = 1, .normal = Vec3::UnitX(), .push = 1},
                    {.object = 2, .point = {2.5, 0, 0}, .normal = Vec3::UnitX(), .push = 2}};
  const Held held = held_hardest(frame, s);
  ASSERT_EQ(held.contacts.size(), 1u);
  EXPECT_EQ(held.contacts[0].point, Vec3(0.5, 0, 0));
  EXPECT_EQ(held.contacts[0].along, Vec3(-1, 0, 0));
  EXPECT_EQ(held.weight, 0.2 * s.gravity);
}

}  // namespace
}  // namespace zwang::god
