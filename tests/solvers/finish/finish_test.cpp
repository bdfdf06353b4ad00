// What finishes an answer: residuals fall, from what a method in double leaves to rounding.
#include <gtest/gtest.h>

#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/registry.h>

#include "tests/parameter_name.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using RealVector = VectorX<long double>;

// Of the rows that push, J z - c over |J| |z| + |c|, the largest.
double active_residual(const Problem& p, const Solution& s) {
  long double worst = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    if (!p.is_equality(i) && !(s.lambda[i] > 0)) continue;
    long double left = -static_cast<long double>(p.c[i]), terms = std::abs(left);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
      const long double term = static_cast<long double>(it.value()) * s.z[it.col()];
      left += term;
      terms += std::abs(term);
    }
    worst = std::max(worst, std::abs(left) / std::max(terms, 1e-300L));
  }
  return static_cast<double>(worst);
}

class Finish : public testing::TestWithParam<const char*> {};

TEST_P(Finish, ThePolishTakesRowsThatPushDownToRoundingOfZ) {
  const Problem p = make_scenes(GetParam()).at(0).problem;
  const Solution before = make_solver("dual_active_set:reduce=off,polish=off").solve(p);
  const Solution after = make_solver("dual_active_set:reduce=off").solve(p);
  ASSERT_EQ(after.status, Status::solved);
  ASSERT_EQ(before.z.size(), after.z.size());
  EXPECT_GT(active_residual(p, before), 0);
  EXPECT_LT(active_residual(p, after), active_residual(p, before));
  EXPECT_LE(active_residual(p, after), std::numeric_limits<double>::epsilon());
}

INSTANTIATE_TEST_SUITE_P(Finish, Finish,
                         testing::Values("random(n=60,m=80,equalities=.4,redundancy=.2,seed=3)", "chain(links=12)",
                                         "hand(contacts=16,seed=2)", "random(n=30,m=40,condition=40)"),
                         [](const auto& i) { return test::parameter_name(i.param); });

// u > 0 on rows that add up to 0 and ask for more than 0.
Problem contradiction(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  constexpr Index n = 8;
  std::vector<test::Row> rows;
  Vector sum = Vector::Zero(n);
  for (Index i = 0; i < 5; ++i) {
    const Vector J = Vector::NullaryExpr(n, [&] { return normal(random); });
    rows.push_back({RowKind::inequality, J, normal(random)});
    sum += J;
  }
  double c = 1;
  for (const test::Row& row : rows) c -= row.c;
  rows.push_back({RowKind::inequality, -sum, c});
  return test::make_problem(Vector::Ones(n), Vector::Zero(n), rows);
}

TEST(FinishOfProofs, ARoughProofIsSharpenedToRounding) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Problem p = contradiction(seed);
    UnitProgram program;
    Solution s;
    ASSERT_TRUE(program.build(p, {}, s));
    Vector u(program.rows()), motion;
    for (Index i = 0; i < u.size(); ++i)  // each row of the problem once, a multiple of the unit row
      u[i] = Vector(p.J.row(program.row[at(i)])).norm();
    std::mt19937 random(seed);
    for (double& x : u) x *= 1 + 1e-7 * std::uniform_real_distribution<double>(-1, 1)(random);
    program.motion(u, motion);
    const double before = motion.norm() / u.norm();
    EXPECT_GT(before, 1e-9);
    Sharpening().run(program, u);
    program.motion(u, motion);
    EXPECT_LE(motion.norm() / u.norm(), 1e-14) << seed;
    EXPECT_TRUE(proves_infeasible(program, u, motion)) << seed;
  }
}

}  // namespace
}  // namespace zwang
