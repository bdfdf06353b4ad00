#include "core/problem.h"

#include <gtest/gtest.h>

#include <limits>

namespace zwang {
namespace {

// One point mass over the floor.
Problem falling_point() {
  Problem p{.name = "point"};
  p.M.resize(3, 3);
  p.M.setIdentity();
  p.z_u = Vec3(0, 0, -10);
  p.J.resize(1, 3);
  p.J.insert(0, 2) = 1;
  p.c = Vector::Zero(1);
  p.kind = {RowKind::inequality};
  p.key = {{}};
  return p;
}

TEST(Problem, AcceptsFiniteEntries) { EXPECT_EQ(bad_input(falling_point()), ""); }

TEST(Problem, NamesTheEntryThatIsNotFinite) {
  Problem p = falling_point();
  p.J.coeffRef(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bad_input(p), "J(0, 2) is not a finite number");
}

TEST(Problem, AllowsMinusInfinityOnInequalityRowsOnly) {
  Problem p = falling_point();
  p.c[0] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(bad_input(p), "");
  p.kind[0] = RowKind::equality;
  EXPECT_EQ(bad_input(p), "c(0) is not a finite number");
}

TEST(Problem, NamesTheAsymmetricEntryOfM) {
  Problem p = falling_point();
  p.M.coeffRef(0, 1) = 0.5;
  EXPECT_EQ(bad_input(p), "M is not symmetric at (0, 1)");
}

TEST(Problem, ThrowsOnMismatchedSizesAndSaysThem) {
  Problem p = falling_point();
  p.c.resize(2);
  try {
    require_matching_sizes(p);
    FAIL() << "nothing was thrown";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("c 2"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace zwang
