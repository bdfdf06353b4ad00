#include <zwang/solvers/linalg/sparse_cholesky.h>

#include <gtest/gtest.h>

#include <random>

namespace zwang {
namespace {

TEST(SparseCholesky, SolvesWithAConnectedMassMatrixOfAnyPattern) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> real(-1, 1);
  for (const Index n : {1, 7, 40}) {
    Matrix A = Matrix::Zero(n, n);
    for (Index i = 0; i < n; ++i) {
      A(i, i) = 4;
      const Index j = static_cast<Index>(random() % static_cast<unsigned>(n));
      if (j != i) A(i, j) = A(j, i) = real(random);
    }
    const Eigen::SparseMatrix<double> M = A.sparseView();
    SparseCholesky<double> factor;
    ASSERT_TRUE(factor.factorize(M));
    Vector b(n);
    for (double& x : b) x = real(random);
    Vector x = b;
    factor.solve_lower(x);
    const double length = x.norm();
    factor.solve_upper(x);
    EXPECT_LE((A * x - b).norm(), 1e-14 * n);
    EXPECT_NEAR(length * length, b.dot(x), 1e-13);
    Vector y = b;
    factor.multiply_upper(y);
    EXPECT_NEAR(y.squaredNorm(), b.dot(A * b), 1e-12 * n);
  }
}

}  // namespace
}  // namespace zwang
