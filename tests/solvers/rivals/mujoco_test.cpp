// The yardstick with soft rows: how far they give way, and what is claimed of them.
#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/yardsticks.h"

namespace zwang {
namespace {

class Mujoco : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_solver("mujoco_newton")) GTEST_SKIP() << "built without MuJoCo";
  }
};

// A mass that falls at 10 m/s^2 onto a floor: the force h / (1 + 1 / stiffness) leaves h / (1 + stiffness).
TEST_F(Mujoco, ARowGivesWayByItsForceOverTheStiffness) {
  const Problem p = make_problem(Matrix{{0, 0, 1}}, Vector{{0}}, Vec3(1, 2, -10));
  for (const double stiffness : {1e2, 1e4, 1e6}) {
    AnySolver solver = make_solver("mujoco_newton:stiffness=" + std::to_string(stiffness));
    const Solution s = solver.solve(p, {.tolerance = 1e-10});
    ASSERT_EQ(s.z.size(), 3) << to_string(s.status);
    EXPECT_NEAR(s.z[2] * (1 + stiffness), -10, 1e-8);
    EXPECT_EQ(s.status, Status::iteration_limit) << "soft rows are not claimed at this tolerance";
    EXPECT_NE(s.message.find("give way"), std::string::npos) << s.message;
  }
}

TEST_F(Mujoco, StifferRowsComeNearer) {
  const Problem p = make_scenes("hand(contacts=16)").front().problem;
  const Solution truth = make_solver("dual_active_set").solve(p);
  ASSERT_EQ(truth.status, Status::solved);
  double last = 1;
  for (const char* stiffness : {"1e4", "1e6", "1e8", "1e10", "1e12"}) {
    const Solution s = make_solver(std::string("mujoco_newton:stiffness=") + stiffness).solve(p, {.tolerance = 1e-8});
    const double error = test::z_error(p, s.z, truth.z);
    EXPECT_LT(error, last / 30) << stiffness;
    EXPECT_TRUE(s.status != Status::solved || error <= 1e-7) << stiffness;
    last = error;
  }
  EXPECT_LT(last, 1e-9);
}

TEST_F(Mujoco, ShownStepsLeadToTheSamePoint) {
  const Problem p = make_scenes("hand(contacts=64)").front().problem;
  AnySolver solver = make_solver("mujoco_newton");
  const Solution unseen = solver.solve(p);
  int shown = 0;
  Solution seen;
  solver.solve(p, {.observe = [&](int iteration, const Vector&, const Vector&) { shown = iteration; }}, seen);
  EXPECT_GT(shown, 2);
  EXPECT_EQ(shown, seen.iterations);
  EXPECT_LE(test::z_error(p, seen.z, unseen.z), 1e-9);
}

TEST_F(Mujoco, StiffnessAboveZeroOnly) {
  const Problem p = make_problem(Matrix{{0, 0, 1}}, Vector{{0}}, Vec3(1, 2, -10));
  EXPECT_EQ(make_solver("mujoco_newton:stiffness=0").supports(p), "its stiffness should be above 0");
}

}  // namespace
}  // namespace zwang
