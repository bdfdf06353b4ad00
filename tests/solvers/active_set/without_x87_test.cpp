// The dual method where long double is no wider than double: refined in double-double.
#define ZWANG_NO_X87
#include <zwang/solvers/active_set/goldfarb_idnani.h>

#include <gtest/gtest.h>

#include "tests/solvers/brute_force.h"
#include "tests/solvers/yardsticks.h"

namespace zwang {
namespace {

static_assert(std::is_same_v<Wider<double>, DoubleDouble>);

TEST(WithoutX87, TheDualMethodAgreesWithEnumeration) {
  GoldfarbIdnani<double> method;
  int solved = 0;
  for (unsigned seed = 1000; seed < 1200; ++seed) {
    const Problem p = random_small_problem(seed);
    const auto truth = brute_force(p);
    const Status status = method.solve(p, {});
    ASSERT_EQ(status, truth ? Status::solved : Status::infeasible) << p.name;
    if (!truth) continue;
    ++solved;
    EXPECT_LE(test::z_error(p, method.z().cast<double>(), truth->z), 1e-13) << p.name;
    EXPECT_FALSE(method.leaves_in_doubt(p, 1e-9)) << p.name;
  }
  EXPECT_GT(solved, 100);
}

}  // namespace
}  // namespace zwang
