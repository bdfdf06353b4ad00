#include <zwang/core/referee/exact_point.h>

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/referee/friction/small_frictional.h"

namespace zwang {
namespace {

using test::SmallFrictional;
using test::vector;

std::optional<ExactPoint> find(const Problem& p, const Vector& z, const Vector& lambda = {}) {
  return exact_point(p, z, {}, {&lambda, 1});
}

const Vector x = vector({1, 0}), y = vector({0, 1});

// x >= 1 and x <= 1 + gap: factors of 106 bits cannot tell the rows apart.
TEST(ExactPoint, WallsAreTwoHoweverNearTheyAre) {
  for (const int k : {10, 52, 200, 900}) {
    Problem p{.z_u = vector({0, 0})};
    p.M = Matrix(Matrix::Identity(2, 2)).sparseView();
    Matrix J(3, 2);
    J << 1, 0, -1, std::ldexp(1, -k), 0, 1;
    p.J = J.sparseView();
    p.kind.assign(3, RowKind::inequality);
    p.key.resize(3);
    p.c = vector({1, -1, 1});  // x >= 1, x <= 1 + 2^-k y, y >= 1
    const auto exact = find(p, vector({1, 1 + 0x1p-24}));
    ASSERT_TRUE(exact) << k;
    EXPECT_NEAR(exact->distance, 0x1p-24, 1e-20);
    EXPECT_NEAR(exact->size, std::sqrt(2), 1e-15);
    p.c[2] = -1;
    p.z_u = vector({2, -1});  // y = -1 would leave no x: it rises to 0
    const auto other = find(p, vector({1, 0}));
    ASSERT_TRUE(other) << k;
    EXPECT_EQ(other->distance, 0);
    p.kind[2] = RowKind::equality;
    EXPECT_FALSE(find(p, vector({1, -1}))) << k;
  }
}

// A push at the edge of the cone, shared by contacts that depend on each other: no slip, and nothing to spare.
TEST(ExactPoint, SeesForcesAtTheEdge) {
  for (const Law law : {Law::coulomb, Law::convex})
    for (const int copies : {1, 2, 5}) {
      SmallFrictional rows{.z_u = vector({3, 4, -10})};
      for (int k = 0; k < copies; ++k)
        rows.contact(.5, {{vector({0, 0, 1}), 0}, {vector({1, 0, 0}), 0}, {vector({0, 1, 0}), 0}});
      const Vector still = Vector::Zero(3);
      const auto exact = find(rows.problem(law), still);
      ASSERT_TRUE(exact) << copies;
      EXPECT_EQ(exact->distance, 0);
      rows.z_u[2] = std::nextafter(-10, 0);  // a little less weight, and it slides
      const auto slides = find(rows.problem(law), still);
      EXPECT_FALSE(slides && slides->distance == 0) << copies;
    }
}

// A block that slides, and what is no solution beside it.
TEST(ExactPoint, BelievesNoForce) {
  const Problem p = test::block(5, 1, .5).problem();
  const Vector right = vector({4.5, 0, 0}), force = vector({1, -.5, 0});
  ASSERT_TRUE(find(p, right, force));
  EXPECT_EQ(find(p, right, force)->distance, 0);
  EXPECT_EQ(find(p, right)->distance, 0);
  EXPECT_EQ(find(p, right, -force)->distance, 0);
  EXPECT_FALSE(find(p, vector({4, 0, 0}), vector({1, -1, 0})));
  EXPECT_FALSE(find(p, vector({5, 0, 0}), vector({1, 0, 0})));
  EXPECT_FALSE(find(p, vector({4.5, 0, 1}), force));
  EXPECT_FALSE(find(p, vector({4.5, 0, -1}), force));
}

// The wedge jams from mu = 3/4 on; Painleve's rod has three answers.
TEST(ExactPoint, KnowsNoneOneAndThree) {
  for (const double mu : {.25, .75 - 0x1p-40, .75, .75 + 0x1p-40, 2.}) {
    const auto jam = find(test::wedge(mu, -1, -1), vector({0, 0}));
    EXPECT_EQ(jam.has_value(), mu < .75) << mu;
  }
  for (const Vector& z : {vector({2, .25, 0}), vector({1.75, .375, -.375}), vector({1.8, .2, -.3})}) {
    const auto exact = find(test::rod(2), z);
    ASSERT_TRUE(exact);
    EXPECT_LT(exact->distance, .2);
  }
}

// Beyond small problems nothing is tried.
TEST(ExactPoint, LeavesWhatIsLarge) {
  Problem p{.z_u = Vector::Ones(100)};
  p.M = Matrix(Matrix::Identity(100, 100)).sparseView();
  p.J.resize(0, 100);
  EXPECT_FALSE(exact_point(p, p.z_u, {}, {}));
}

}  // namespace
}  // namespace zwang
