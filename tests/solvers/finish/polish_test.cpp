#include <zwang/solvers/finish/extended_polish.h>

#include <gtest/gtest.h>

#include "tests/solvers/brute_force.h"
#include "tests/solvers/yardsticks.h"

namespace zwang {
namespace {

// What refines where long double is no wider than double. The guess is the equality rows alone. What is promised holds.
TEST(ExtendedPolish, InDoubleDoubleAloneAgreesWithEnumerationAndBoundsItsError) {
  int solved = 0, bounded = 0;
  for (unsigned seed = 1000; seed < 1200; ++seed) {
    const Problem p = random_small_problem(seed);
    const auto truth = brute_force(p);
    Whitened rows;
    Solution s;
    ASSERT_TRUE(begin(rows, p, {}, Deadline(), s)) << p.name;
    const Deadline deadline;
    QrRows active;
    active.reset(rows, deadline);
    for (Index i = 0; i < rows.rows(); ++i)
      if (rows.equality[static_cast<std::size_t>(i)]) active.append(i);
    ExtendedPolish<DoubleDouble> polish;
    ASSERT_TRUE(polish.run(p, rows, active, SolveOptions{.tolerance = 1e-10, .accuracy = 1e-4}, s)) << p.name;
    ASSERT_EQ(s.status == Status::infeasible, !truth) << p.name;
    if (!truth) continue;
    ++solved;
    EXPECT_EQ(s.status, Status::solved) << p.name;
    EXPECT_LE(test::z_error(p, s.z, truth->z), 1e-13) << p.name;
    if (std::isnan(s.error_bound)) continue;  // rows that depend on each other
    ++bounded;
    EXPECT_LE(s.error_bound, 1e-13) << p.name;
    EXPECT_LE(test::z_error(p, s.z, truth->z), s.error_bound + 1e-14) << p.name;
  }
  EXPECT_GT(solved, 100);
  EXPECT_GT(bounded, 50);
}

}  // namespace
}  // namespace zwang
