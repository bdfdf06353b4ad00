#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/registry.h>
#include "tests/bench/fuzz/failing_allocations.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

// The n-th allocation of a solve fails, for every n: either it says so, or its answer is right; and afterwards the same
// object solves as if nothing had happened.
void refuse_each_in_turn(const std::string& name, const Problem& problem) {
  const Solution truth = make_solver(name).solve(problem);
  int said = 0;
  for (long n = 1;; ++n) {
    ASSERT_LT(n, 100000);
    AnySolver solver = make_solver(name);
    Solution s;
    refuse_allocation(n);
    solver.solve(problem, {}, s);
    const bool reached = allocation_was_refused();
    refuse_allocation(0);
    if (s.message == "out of memory") {
      ++said;
      ASSERT_EQ(s.status, Status::numerical_failure);
    } else {
      ASSERT_EQ(s.status, truth.status) << "allocation " << n;
      if (truth.status == Status::solved) {
        ASSERT_LE(test::z_error(problem, s.z, truth.z), 1e-12) << "allocation " << n;
      }
    }
    solver.solve(problem, {}, s);
    ASSERT_EQ(s.status, truth.status) << "after allocation " << n << " was refused";
    ASSERT_EQ(s.z, truth.z) << "after allocation " << n << " was refused";
    if (!reached) break;
  }
  EXPECT_GT(said, 20) << "a solve takes more blocks than that";
}

class OutOfMemory : public testing::TestWithParam<const char*> {};

TEST_P(OutOfMemory, HandEndsCleanlyOrRight) {
  for (const Instance& hand : make_scenes("hand(contacts=16,64)")) refuse_each_in_turn(GetParam(), hand.problem);
}

TEST_P(OutOfMemory, SmallAndContradictingProblemsToo) {
  for (const Instance& small : make_scenes("GAP(k=3),GAP(k=40),INC(k=3),LOOP(k=60),NPI(k=30),MANYF"))
    refuse_each_in_turn(GetParam(), small.problem);
}

INSTANTIATE_TEST_SUITE_P(Solvers, OutOfMemory, testing::Values("dual_active_set", "nnls"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace zwang
