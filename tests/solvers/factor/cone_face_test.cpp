// The rows of a cone program and the factor of M + G'D G, dense and sparse, against dense matrices.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include <zwang/solvers/factor/dense_face.h>
#include <zwang/solvers/factor/sparse_face.h>

namespace zwang {
namespace {

constexpr Index cones = 5, rays = 3, bodies = 4, rows = 3 * cones + rays;
constexpr double rounding = 1e-11;

class Faces : public testing::Test {
 protected:
  void SetUp() override {
    const Index n = 6 * bodies;
    for (Index k = 0; k < cones + rays; ++k) {  // each on two bodies
      const Index first = 6 * (k % bodies), second = 6 * ((k + 1) % bodies), at = k < cones ? 3 * k : 2 * cones + k;
      const Index count = k < cones ? 3 : 1;
      G_.block(at, first, count, 6) = random(count, 6);
      G_.block(at, second, count, 6) = random(count, 6);
    }
    const Matrix L = random(6, 6);
    Mat<double, 6, 6> mass = L * L.transpose() + Matrix::Identity(6, 6);
    M_.setIdentity(n, n);
    for (Index b = 0; b < bodies; ++b) M_.block<6, 6>(6 * b, 6 * b) = (1.0 + static_cast<double>(b)) * mass;
    for (Index k = 0; k < cones; ++k) {
      Mat3 block = random(3, 3);
      block = (block * block.transpose()).eval();
      if (k == 1) block.setZero();  // an open contact
      Eigen::Map<Mat3>(D_.data() + 9 * k) = block;
    }
    ray_weight_ << 2, 0, 100;
  }
  Matrix random(Index n, Index m) {
    return Matrix::NullaryExpr(n, m, [&] { return std::uniform_real_distribution<double>(-1, 1)(generator_); });
  }
  // M + G'D G.
  Matrix matrix(const Matrix& M, const Matrix& G) const {
    Matrix H = M;
    for (Index k = 0; k < cones; ++k)
      H += G.middleRows(3 * k, 3).transpose() * Eigen::Map<const Mat3>(D_.data() + 9 * k) * G.middleRows(3 * k, 3);
    for (Index r = 0; r < rays; ++r) H += ray_weight_[r] * G.row(3 * cones + r).transpose() * G.row(3 * cones + r);
    return H;
  }
  // Against G and M with columns in the order of the face's unknowns.
  void expect_rows_and_factor(ConeFace& face, const Matrix& M, const Matrix& G, bool symmetric) {
    Vector v = Vector::Zero(face.unknowns()), f = v;
    v.head(G.cols()) = random(G.cols(), 1);
    const Vector l = random(rows, 1);
    Vector s(rows);
    face.slack(v, s);
    EXPECT_LE((s - G * v.head(G.cols())).norm(), rounding);
    face.force(l, f);
    EXPECT_LE((f.head(G.cols()) - G.transpose() * l).norm(), rounding);
    face.mass(v, f);
    EXPECT_LE((f.head(G.cols()) - M * v.head(G.cols())).norm(), rounding);
    ASSERT_TRUE(face.factorize(D_, ray_weight_, symmetric));
    f = v;
    face.solve(f);
    EXPECT_LE((matrix(M, G) * f.head(G.cols()) - v.head(G.cols())).norm(), rounding);
    EXPECT_GT(f.norm(), 0.001);
    expect_single_rows(face, M, G);
  }
  void expect_single_rows(ConeFace& face, const Matrix& M, const Matrix& G) {
    ASSERT_TRUE(face.divide_rows());
    const Matrix images = M.inverse() * G.transpose();
    Vector v = Vector::Zero(face.unknowns());
    v.head(G.cols()) = random(G.cols(), 1);
    for (Index r = 0; r < rows; ++r) {
      EXPECT_NEAR(face.along(r, v), G.row(r).dot(v.head(G.cols())), rounding);
      const Vector before = v;
      face.push(r, 0.7, v);
      EXPECT_LE((v.head(G.cols()) - before.head(G.cols()) - 0.7 * images.col(r)).norm(), rounding);
      const Index q = r < 3 * cones ? r / 3 * 3 : r;  // of the same cone
      EXPECT_NEAR(face.delassus(r, q), G.row(r).dot(images.col(q)), rounding);
      EXPECT_NEAR(face.delassus(q, r), G.row(r).dot(images.col(q)), rounding);
    }
  }

  std::mt19937 generator_{3};
  Matrix G_ = Matrix::Zero(rows, 6 * bodies), M_;
  std::vector<double> D_ = std::vector<double>(9 * cones);
  Vector ray_weight_ = Vector::Zero(rays);
};

TEST_F(Faces, DenseRowsAndBothFactors) {
  // As they are, and with each body's columns so far apart that a part of the unknowns is more than one tile.
  Matrix apart = Matrix::Zero(rows, 300);
  for (Index b = 0; b < bodies; ++b) apart.middleCols(85 * b, 6) = G_.middleCols(6 * b, 6);
  DenseFace face;
  for (const Matrix& G : {G_, apart, G_})
    for (const bool symmetric : {true, false, true}) {
      if (!symmetric)
        for (Index k = 0; k < cones; ++k) D_[at(9 * k + 1)] += 0.25;
      face.reset(G.cols(), cones, rays);
      for (Index r = 0; r < rows; ++r) std::copy_n(Vector(G.row(r)).data(), G.cols(), face.row(r));
      face.rows_are_set();
      if (symmetric)
        for (Index k = 0; k < cones; ++k) D_[at(9 * k + 1)] = D_[at(9 * k + 3)];
      expect_rows_and_factor(face, Matrix::Identity(G.cols(), G.cols()), G, symmetric);
    }
}

TEST_F(Faces, SparseRowsInTheOrderOfElimination) {
  Problem problem;
  problem.M = M_.sparseView();
  problem.z_u.setZero(G_.cols());
  SparseRows sparse;
  for (Index r = 0; r < rows; ++r) {
    for (Index j = 0; j < G_.cols(); ++j) {
      if (G_(r, j) == 0) continue;
      sparse.column.push_back(static_cast<int>(j));
      sparse.value.push_back(G_(r, j));
    }
    sparse.begin.push_back(static_cast<int>(sparse.column.size()));
  }
  SparseFace face;
  face.reset(problem, sparse, cones, {}, Deadline());
  ASSERT_EQ(face.unknowns(), G_.cols());
  std::vector<Index> order;
  for (Index u = 0; u < face.unknowns(); ++u) order.push_back(face.column(u));
  expect_rows_and_factor(face, M_(order, order), G_(Eigen::all, order), true);
  // By LU once it is asked for, and by Cholesky factors again.
  EXPECT_FALSE(face.takes_unsymmetric());
  face.couple();
  ASSERT_TRUE(face.takes_unsymmetric());
  const std::vector<double> symmetric = D_;
  for (Index k = 0; k < cones; ++k) D_[at(9 * k + 1)] += 0.25;
  expect_rows_and_factor(face, M_(order, order), G_(Eigen::all, order), false);
  D_ = symmetric;
  expect_rows_and_factor(face, M_(order, order), G_(Eigen::all, order), true);
}

// Rows whose images under M^-1 would be dense.
TEST_F(Faces, RowsAreNotDividedWhereMTiesManyUnknowns) {
  constexpr Index n = 60;
  for (const Index tied : {Index(48), n}) {
    Problem problem;
    Matrix M = Matrix::Identity(n, n);
    for (Index j = 1; j < tied; ++j) M(j, j - 1) = M(j - 1, j) = 0.25;
    problem.M = M.sparseView();
    problem.z_u.setZero(n);
    SparseRows sparse;
    for (int j = 0; j + 1 < n; ++j) {
      sparse.column.insert(sparse.column.end(), {j, j + 1});
      sparse.value.insert(sparse.value.end(), {1, -1});
      sparse.begin.push_back(static_cast<int>(sparse.column.size()));
    }
    SparseFace face;
    face.reset(problem, sparse, 0, {}, Deadline());
    EXPECT_EQ(face.divide_rows(), tied == 48);
  }
}

}  // namespace
}  // namespace zwang
