#include <zwang/solvers/finish/extended_polish.h>

#include <gtest/gtest.h>

#include <zwang/solvers/registry.h>
#include "tests/solvers/brute_force.h"
#include "tests/solvers/small_problems.h"
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

// Rows 2^-44 and 2^-38 from others: doubles take the last of four active rows for a clear one, depending on their
// order, and corrections of 1e-13 of the motion lead to it, a thousandth of a thousandth of the way each.
TEST(ExtendedPolish, ARowThatManySmallCorrectionsWouldReachIsNotCalledSolved) {
  const double near = 0x1p-44, less = 0x1p-38;
  std::vector<test::Row> contacts = {
      {RowKind::inequality, test::vec({4, 0, -4, 12}), -24},
      {RowKind::inequality, test::vec({1, 0, 0, -3}), 1},
      {RowKind::inequality, test::vec({1 - near, near, -1, 3}), -6 + 4 * near},
      {RowKind::inequality, test::vec({-2, 1, 3, 3}), 4},
      {RowKind::inequality, test::vec({1 - less, 0, less / 2, -3 + less / 2}), 1 + 2 * less},
  };
  std::vector<Index> order = {0, 1, 2, 3, 4}, columns = {0, 1, 2, 3};
  do {
    for (int turn = 0; turn < 4; ++turn) {
      std::ranges::rotate(columns, columns.begin() + 1);
      const auto placed = [&](const Vector& v) { return Vector(v(columns)); };
      std::vector<test::Row> rows = {{RowKind::equality, placed(test::vec({1, 0, -1, 3})), -6},
                                     {RowKind::equality, placed(test::vec({1, 1, -1, 0})), -1}};
      for (const Index i : order) {
        rows.push_back(contacts[static_cast<std::size_t>(i)]);
        rows.back().J = placed(rows.back().J);
      }
      const Problem p = test::make_problem(Vector::Ones(4), placed(test::vec({3, -4, 1, -1})), rows);
      for (const char* name : {"nnls", "cholesky", "dual_active_set"}) {
        const Solution s = make_solver(name).solve(p);
        EXPECT_TRUE(s.status != Status::solved || test::z_error(p, s.z, placed(test::vec({-2, 2, 1, -1}))) <= 1e-9)
            << name;
      }
    }
  } while (std::ranges::next_permutation(order).found);
}

}  // namespace
}  // namespace zwang
