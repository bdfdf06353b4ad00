#include <zwang/constraints/contact.h>

#include <gtest/gtest.h>

#include <numbers>

#include <zwang/core/model/assemble.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

TEST(ContactFrame, IsRightHandedAndOrthonormal) {
  for (int k = 0; k < 1000; ++k) {
    const Mat3 frame = contact_frame(Vec3::Random().normalized());
    EXPECT_LE((frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(frame.determinant(), 0);
  }
}

TEST(ContactFrame, OfAFloorAndACeilingIsTheAxes) {
  Mat3 floor, ceiling;
  floor << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  ceiling << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  EXPECT_EQ(contact_frame(Vec3::UnitZ()), floor);
  EXPECT_EQ(contact_frame(-Vec3::UnitZ()), ceiling);
}

// Around every floor, wall and ceiling, also where the normal only trembles.
TEST(ContactFrame, TurnsWithTheNormal) {
  for (const double tilt : {0., 1e-12, 1e-6, 0.1, 0.5 * std::numbers::pi, std::numbers::pi - 1e-6, std::numbers::pi})
    for (int k = 0; k < 64; ++k) {
      const double angle = k * std::numbers::pi / 32;
      const auto normal = [&](double t, double a) {
        return Vec3(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
      };
      const Vec3 here = normal(tilt, angle), there = normal(tilt + 1e-7, angle + 1e-7);
      EXPECT_LE((contact_frame(here) - contact_frame(there)).norm(), 1e-6) << tilt << " " << angle;
    }
}

// A box of 1 kg on a conveyor, 1/8 m off its middle.
struct OnABelt : ::testing::Test {
  OnABelt() {
    Body ground, box;
    ground.motion = Motion::fixed;
    box.pose.position = {0, 0, 0.5};
    box.velocity << 1, -0.5, 0, 0, 0, 2;
    scene.add(ground);
    scene.add(box);
    contact = contact_at(scene.bodies, 1, 0, {0.125, 0, 0}, Vec3::UnitZ(), 0.25, 0.5);
    contact.surface = {3, 0, 7};
  }
  Problem assemble(Mode mode) {
    scene.list_of<Contact>().all.clear();
    scene.list_of<Contact>().labels.clear();
    scene.list_of<Contact>().keys.clear();
    scene.add(contact, "box");
    Problem problem;
    assembler.assemble(scene, Vector::Zero(6), {.dt = 0.25, .mode = mode}, problem);
    return problem;
  }
  Scene scene;
  Contact contact;
  Assembler assembler;
};

TEST_F(OnABelt, TangentRowsAreTheSlipOverTheFace) {
  const Problem p = assemble(Mode::dynamic);
  ASSERT_EQ(p.rows(), 3);
  EXPECT_EQ(p.kind, (std::vector{RowKind::inequality, RowKind::tangent, RowKind::tangent}));
  Matrix J(3, 6);
  J << 0, 0, 1, 0, -0.125, 0,  // at (1/8, 0, -1/2) from the middle
      1, 0, 0, 0, -0.5, 0,     //
      0, 1, 0, 0.5, 0, 0.125;
  EXPECT_EQ(Matrix(p.J), J);
  // -0.25 / dt^2; (3 - 1) / dt; -(-0.5 + 2/8) / dt. No position term in the last two.
  EXPECT_EQ(p.c, Vec3(-4, 8, 1));
  EXPECT_EQ(p.mu, Vec3(0.5, 0, 0));
  EXPECT_EQ(p.law, Law::coulomb);
  EXPECT_EQ(bad_input(p), "");
  EXPECT_EQ(p.key[2], (RowKey{p.key[0].constraint, 2}));
  std::vector<std::string> names;
  for (const RowOrigin& origin : assembler.origin(scene, p)) names.push_back(to_string(origin));
  EXPECT_EQ(names, (std::vector<std::string>{"contact/box", "contact/box [1]", "contact/box [2]"}));
}

TEST_F(OnABelt, AtRestOnlyTheBeltRuns) { EXPECT_EQ(assemble(Mode::quasi_static).c, Vec3(-4, 12, 0)); }

TEST_F(OnABelt, APrescribedBeltRunsByItsOwnMotion) {
  scene.bodies[0].motion = Motion::prescribed;
  scene.bodies[0].prescribed << 5, 0, 0, 0, 0, 0;
  EXPECT_EQ(assemble(Mode::dynamic).c, Vec3(-4, 13, 1));
}

TEST_F(OnABelt, WithoutFrictionThereIsOneRow) {
  const Problem with = assemble(Mode::dynamic);
  contact.friction = 0;
  const Problem without = assemble(Mode::dynamic), left_out = under(Law::frictionless, with);
  EXPECT_FALSE(without.has_tangents());
  EXPECT_EQ(without.law, Law::frictionless);
  EXPECT_EQ(Matrix(without.J), Matrix(left_out.J));
  EXPECT_EQ(without.c, left_out.c);
  EXPECT_EQ(without.key, left_out.key);
}

TEST_F(OnABelt, ABadCoefficientIsSeen) {
  for (const double mu : {-0.5, std::numeric_limits<double>::quiet_NaN()}) {
    contact.friction = mu;
    EXPECT_NE(bad_input(assemble(Mode::dynamic)).find("mu(0)"), std::string::npos) << mu;
  }
}

}  // namespace
}  // namespace zwang
