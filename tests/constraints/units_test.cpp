#include <zwang/constraints/units.h>

#include <gtest/gtest.h>

namespace zwang {
namespace {

TEST(Units, LengthsAndAnglesOfAJointsRows) {
  for (int row = 0; row < 3; ++row)
    EXPECT_EQ(row_unit("revolute_joint/elbow [" + std::to_string(row) + "]"), "m/s^2") << row;
  for (int row = 3; row < 5; ++row)
    EXPECT_EQ(row_unit("revolute_joint/elbow [" + std::to_string(row) + "]"), "rad/s^2") << row;
  EXPECT_EQ(row_unit("prismatic_joint/rail [1]"), "m/s^2");
  EXPECT_EQ(row_unit("prismatic_joint/rail [2]"), "rad/s^2");
}

TEST(Units, ConstraintsOfOneRow) {
  EXPECT_EQ(row_unit("contact/box 3 on box 2, corner 1"), "m/s^2");
  EXPECT_EQ(row_unit("rope/dog 1 to owner"), "m/s^2");
  EXPECT_EQ(row_unit("joint_limit/index, lower"), "rad/s^2");
}

TEST(Units, NoneWhereNoConstraintMadeTheRow) {
  EXPECT_EQ(row_unit("equality/17"), "");
  EXPECT_EQ(row_unit("row 17"), "");
  EXPECT_EQ(row_unit("revolute_joint/elbow [9]"), "");
}

}  // namespace
}  // namespace zwang
