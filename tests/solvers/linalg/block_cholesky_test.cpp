#include <zwang/solvers/linalg/block_cholesky.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <utility>

#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/linalg/dense_front.h>

namespace zwang {
namespace {

struct System {
  Eigen::SparseMatrix<double> M;
  SparseRows rows;
  std::vector<double> weight;
};

// Bodies of six unknowns with dense blocks in M, in `islands` parts; rows over two bodies of a part.
System random_system(unsigned seed, int bodies, int rows, int islands = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto pick = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most)); };
  System s;
  std::vector<Eigen::Triplet<double>> entries;
  for (int b = 0; b < bodies; ++b) {
    const Mat<double, 6, 6> A = Mat<double, 6, 6>::NullaryExpr([&] { return normal(random); });
    const Mat<double, 6, 6> block = A * A.transpose() + Mat<double, 6, 6>::Identity();
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) entries.emplace_back(6 * b + i, 6 * b + j, block(i, j));
  }
  s.M.resize(6 * bodies, 6 * bodies);
  s.M.setFromTriplets(entries.begin(), entries.end());
  for (int k = 0; k < rows; ++k) {
    const int island = pick(islands), a = island + islands * pick(bodies / islands),
              b = island + islands * pick(bodies / islands);
    for (const int body : {std::min(a, b), std::max(a, b)}) {
      for (int i = 0; i < 6; ++i) {
        s.rows.column.push_back(6 * body + i);
        s.rows.value.push_back(normal(random));
      }
      if (a == b) break;
    }
    s.rows.begin.push_back(static_cast<int>(s.rows.value.size()));
    s.weight.push_back(pick(3) ? std::exp(3 * normal(random)) : 0);
  }
  return s;
}

Matrix dense(const System& s) {
  Matrix H(s.M);
  for (int i = 0; i < s.rows.rows(); ++i) {
    Vector g = Vector::Zero(H.rows());
    for (int e = s.rows.begin[static_cast<std::size_t>(i)]; e < s.rows.begin[static_cast<std::size_t>(i) + 1]; ++e)
      g[s.rows.column[static_cast<std::size_t>(e)]] += s.rows.value[static_cast<std::size_t>(e)];
    H += s.weight[static_cast<std::size_t>(i)] * g * g.transpose();
  }
  return H;
}

// |H x - b| of what solve() makes of b, relative to |H| |x|, over the columns that are not loose.
double residual(const System& s, const BlockCholesky& factor) {
  const Matrix H = dense(s);
  Vector b(factor.size());
  for (Index j = 0; j < b.size(); ++j) b[j] = std::sin(static_cast<double>(j) + 1);
  Vector x = b, whole = Vector::Zero(H.rows());
  factor.solve(x);
  for (int j = 0; j < factor.size(); ++j) whole[factor.column(j)] = x[j];
  const Vector product = H * whole;
  double worst = 0;
  for (int j = 0; j < factor.size(); ++j) worst = std::max(worst, std::abs(product[factor.column(j)] - b[j]));
  return worst / (H.norm() * x.norm());
}

TEST(BlockCholesky, SolvesLikeADenseFactor) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const System s = random_system(seed, 1 + static_cast<int>(seed), static_cast<int>(3 * seed));
    BlockCholesky factor;
    factor.analyze(s.M, s.rows);
    ASSERT_TRUE(factor.factorize(s.M, s.rows, s.weight)) << seed;
    if (factor.size() > 0) {
      EXPECT_LE(residual(s, factor), 1e-14) << seed;
    }
    for (int j = 0; j < factor.size(); ++j) EXPECT_EQ(factor.position(factor.column(j)), j);
  }
}

// Rows come and go: only the fronts that they change are factorized again, to the same bits as all of them.
TEST(BlockCholesky, KeepsTheFrontsThatDidNotChange) {
  System s = random_system(7, 20, 50);
  BlockCholesky kept, fresh;
  kept.analyze(s.M, s.rows);
  ASSERT_TRUE(kept.factorize(s.M, s.rows, s.weight));
  std::mt19937 random(3);
  for (int change = 0; change < 20; ++change) {
    double& weight = s.weight[random() % s.weight.size()];
    weight = weight > 0 ? 0 : 10;
    const long before = allocations();
    ASSERT_TRUE(kept.factorize(s.M, s.rows, s.weight));
    EXPECT_EQ(allocations() - before, 0);
    fresh.analyze(s.M, s.rows);
    ASSERT_TRUE(fresh.factorize(s.M, s.rows, s.weight));
    Vector x = Vector::Ones(kept.size()), y = x;
    kept.solve(x);
    fresh.solve(y);
    EXPECT_EQ(x, y);
    EXPECT_LE(residual(s, kept), 1e-14);
  }
}

TEST(BlockCholesky, CountsItsPartsAndLeavesLooseColumnsOut) {
  const System s = random_system(2, 12, 60, 3);
  BlockCholesky factor;
  factor.analyze(s.M, s.rows);
  EXPECT_EQ(factor.parts(), 3);
  for (int i = 0; i < s.rows.rows(); ++i) {
    const int column = s.rows.column[static_cast<std::size_t>(s.rows.begin[static_cast<std::size_t>(i)])];
    EXPECT_EQ(factor.part_of_row(i), factor.part_of_position(factor.position(column)));
  }
  // A diagonal M: what no row touches is loose.
  System diagonal{.M = Eigen::SparseMatrix<double>(12, 12), .rows = {}, .weight = {1}};
  diagonal.M.setIdentity();
  diagonal.rows.column = {3, 7};
  diagonal.rows.value = {1, -1};
  diagonal.rows.begin.push_back(2);
  BlockCholesky small;
  small.analyze(diagonal.M, diagonal.rows);
  EXPECT_EQ(small.size(), 2);
  EXPECT_EQ(small.position(0), -1);
  ASSERT_TRUE(small.factorize(diagonal.M, diagonal.rows, diagonal.weight));
  EXPECT_LE(residual(diagonal, small), 1e-15);
}

TEST(BlockCholesky, SaysNoToAMatrixThatIsNotPositiveDefinite) {
  System s = random_system(5, 4, 10);
  for (double& weight : s.weight) weight = -1e6;
  BlockCholesky factor;
  factor.analyze(s.M, s.rows);
  EXPECT_FALSE(factor.factorize(s.M, s.rows, s.weight));
  for (double& weight : s.weight) weight = 1;
  ASSERT_TRUE(factor.factorize(s.M, s.rows, s.weight));
  EXPECT_LE(residual(s, factor), 1e-14);
}

// Fronts of all sizes, those with copied columns among them: the factor of the first columns, and what they leave.
TEST(DenseFront, FactorizesTheFirstColumnsAndLeavesTheSchurComplement) {
  for (const auto& [size, own] :
       {std::pair{7, 7}, {31, 13}, {150, 66}, {200, 200}, {301, 201}, {330, 130}, {260, 258}}) {
    const Matrix B = Matrix::Random(size, size), A = B * B.transpose() + size * Matrix::Identity(size, size);
    const Index stride = (size + DenseFront::lanes - 1) / DenseFront::lanes * DenseFront::lanes;
    Matrix front = Matrix::Zero(stride, size + 1);
    front.topLeftCorner(size, size) = A;
    Vector scratch(DenseFront::scratch_for(own));
    ASSERT_TRUE(
        DenseFront::factorize({front.data(), front.col(own).data(), own, stride}, size, scratch.data(), Deadline()));
    const Matrix L = A.topLeftCorner(own, own).llt().matrixL();
    Matrix expected = L;
    expected.diagonal() = L.diagonal().cwiseInverse();
    const Matrix off = (front.topLeftCorner(own, own) - expected).triangularView<Eigen::Lower>();
    EXPECT_LE(off.norm(), 1e-13 * A.norm()) << size << ", " << own;
    const Index rest = size - own;
    if (rest == 0) continue;
    const Matrix below = L.triangularView<Eigen::Lower>().solve(A.bottomLeftCorner(rest, own).transpose()).transpose();
    const Matrix left = A.bottomRightCorner(rest, rest) - below * below.transpose();
    EXPECT_LE((front.block(own, 0, rest, own) - below).norm(), 1e-13 * A.norm()) << size << ", " << own;
    const Matrix off_left = (front.block(own, own, rest, rest) - left).triangularView<Eigen::Lower>();
    EXPECT_LE(off_left.norm(), 1e-13 * A.norm()) << size << ", " << own;
  }
}

}  // namespace
}  // namespace zwang
