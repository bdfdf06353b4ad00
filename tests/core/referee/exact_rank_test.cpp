#include <zwang/core/referee/exact_rank.h>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <numeric>
#include <random>

namespace zwang {
namespace {

struct Rows {
  RowMatrix J;
  Vector c;
  explicit Rows(const Matrix& joined)
      : J(joined.leftCols(joined.cols() - 1).sparseView()), c(joined.col(joined.cols() - 1)) {}
  Consistency ask(const std::vector<Index>& basis, const std::vector<Index>& more) const {
    return exact_consistency(J, c, basis, more);
  }
};

TEST(ExactRank, TellsTheThreeCasesApart) {
  const Rows rows(
      Matrix{{1, 2, 0, 5}, {0, 1, 1, 1}, {1, 3, 1, 6}, {1, 3, 1, 7}, {0, 0, 1, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}});
  EXPECT_EQ(rows.ask({0, 1}, {2}), Consistency::consistent);
  EXPECT_EQ(rows.ask({0, 1}, {2, 3}), Consistency::contradictory);
  EXPECT_EQ(rows.ask({0, 1}, {4}), Consistency::independent);
  EXPECT_EQ(rows.ask({0, 1}, {5}), Consistency::consistent);
  EXPECT_EQ(rows.ask({0, 1}, {6}), Consistency::contradictory);
  EXPECT_EQ(rows.ask({0, 1, 2}, {}), Consistency::independent) << "the basis is none";
  EXPECT_EQ(rows.ask({}, {}), Consistency::consistent);
}

// Four integer rows whose determinant is the product of two primes of 61 bits, which were once the only ones asked.
TEST(ExactRank, PrimesThatSomebodyKnowsProveNothing) {
  constexpr double x = 0x1p40;
  const Rows rows(
      Matrix{{x, -1, 0, 0, 0}, {0, x, -1, 0, 0}, {0, 0, x, -1, 0}, {164241046457, 41332614815, 860325496455, 1, 0}});
  EXPECT_EQ(rows.ask({0, 1, 2}, {3}), Consistency::independent);
}

// Doubles count as they are stored: three times 0.1 is not 0.3, half of it is, at any power of two.
TEST(ExactRank, TakesDoublesAsTheyAreStored) {
  EXPECT_EQ(Rows(Matrix{{.1, 1, 1}, {.3, 3, 3}}).ask({0}, {1}), Consistency::independent);
  EXPECT_EQ(Rows(Matrix{{.1, .7, 1}, {.05, .35, .5}}).ask({0}, {1}), Consistency::consistent);
  for (const int e : {-1000, -500, 500, 1000}) {
    const double unit = std::ldexp(1.0, e);
    EXPECT_EQ(Rows(Matrix{{.1, .7, -1}, {.1 * unit, .7 * unit, -unit}}).ask({0}, {1}), Consistency::consistent) << e;
    EXPECT_EQ(Rows(Matrix{{.1, .7, 0}, {.1, .7, unit}}).ask({0}, {1}), Consistency::contradictory) << e;
    EXPECT_EQ(Rows(Matrix{{1, 0, 0}, {1, unit, 0}}).ask({0}, {1}), Consistency::independent) << e;
  }
}

TEST(ExactRank, FindsABasisOfTernaryRowsAndWhetherTheyAreConsistent) {
  std::mt19937 random(3);
  int contradictory = 0, dependent = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Index m = 1 + static_cast<Index>(random() % 6), n = 1 + static_cast<Index>(random() % 4);
    Matrix joined(m, n + 1);
    for (double& a : joined.reshaped()) a = static_cast<double>(random() % 3) - 1;
    const Rows rows(joined);
    std::vector<Index> all(static_cast<std::size_t>(m));
    std::iota(all.begin(), all.end(), Index{0});
    const ExactBasis basis = exact_basis(rows.J, rows.c, all);
    const auto rank = [](const Matrix& A) { return Eigen::FullPivLU<Matrix>(A).rank(); };
    ASSERT_EQ(static_cast<Index>(basis.rows.size()), rank(Matrix(rows.J))) << trial;
    ASSERT_EQ(basis.contradictory.empty(), rank(joined) == rank(Matrix(rows.J))) << trial;
    // Each row stays out only if it depends on the rows before it.
    std::size_t next = 0;
    for (Index i = 0; i < m; ++i) {
      const bool in = next < basis.rows.size() && basis.rows[next] == i;
      next += in;
      ASSERT_EQ(static_cast<Index>(next), rank(Matrix(rows.J).topRows(i + 1))) << trial;
      dependent += !in;
    }
    contradictory += !basis.contradictory.empty();
  }
  EXPECT_GT(contradictory, 100);
  EXPECT_GT(dependent, 300);
}

}  // namespace
}  // namespace zwang
