#include <zwang/solvers/linalg/sparse_qr.h>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include <algorithm>
#include <numeric>
#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/form/equality_elimination.h>
#include <zwang/solvers/linalg/library_memory.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

// Before the first solver: a program that counts allocations asks for SuiteSparse's to be kept.
[[maybe_unused]] const bool keeps_library_memory = (LibraryMemory::install(), true);

constexpr double tolerance = 1.4e-14;

// Columns of length 1 with five entries each; every tenth is the sum of two before it, of length 1 again.
Matrix unit_rows(Index n, Index m, bool redundant, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto draw = [&](Index below) { return static_cast<Index>(random() % static_cast<unsigned>(below)); };
  Matrix Gt = Matrix::Zero(n, m);
  for (Index j = 0; j < m; ++j) {
    if (redundant && j % 10 == 9) {
      const Index a = j - 1 - draw(4), b = j - 5 - draw(4);
      Gt.col(j) = Gt.col(a) + Gt.col(b);
    } else {
      for (int k = 0; k < 5; ++k) Gt(draw(n), j) = static_cast<double>(1 + draw(8)) * (draw(2) ? 1 : -1);
    }
    Gt.col(j).normalize();
  }
  return Gt;
}

SparseQr::Rows rows_of(const Matrix& Gt) { return Gt.transpose().sparseView(); }

std::vector<Index> all_of(Index m) {
  std::vector<Index> rows(static_cast<std::size_t>(m));
  std::iota(rows.begin(), rows.end(), Index{0});
  return rows;
}

TEST(SparseQr, FactorsAreThoseOfTheRows) {
  const Index n = 400, m = 200;
  for (const bool redundant : {false, true}) {
    const Matrix Gt = unit_rows(n, m, redundant);
    SparseQr qr;
    ASSERT_TRUE(qr.factorize(rows_of(Gt), all_of(m), tolerance, Deadline()));
    const auto rank = static_cast<Index>(qr.order().size());
    EXPECT_EQ(rank, redundant ? m - m / 10 : m);
    EXPECT_EQ(std::ssize(qr.rejected()), m - rank);

    // Q'x and back; what is free of a row is nothing.
    Vector x = Vector::LinSpaced(n, -1, 2), y = x;
    qr.rotate(y);
    EXPECT_NEAR(y.norm(), x.norm(), 1e-13 * x.norm());
    qr.rotate_back(y);
    EXPECT_LE((y - x).norm(), 1e-13 * x.norm());
    Matrix A;
    qr.reduce(rows_of(Gt), all_of(m), A);
    EXPECT_EQ(A.rows(), n - rank);
    EXPECT_LE(A.cwiseAbs().maxCoeff(), 1e-14);
    for (const Index j : qr.rejected()) EXPECT_LE(A.col(j).norm(), 4e-15) << j;

    // R' w = h is solved by the point that meets the rows, R mu = Q'g by a row's combination: itself.
    const Matrix accepted = Gt(Eigen::all, qr.order());
    Vector h = Vector::LinSpaced(rank, 1, 3), w = h, point = Vector::Zero(n);
    qr.solve_transposed(w);
    point.head(rank) = w;
    qr.rotate_back(point);
    EXPECT_LE((accepted.transpose() * point - h).norm(), 1e-12 * h.norm());
    for (Index k = 0; k < rank; ++k) {
      Vector mu = accepted.col(k);
      qr.rotate(mu);
      qr.solve(mu.head(rank));
      EXPECT_LE((mu.head(rank) - Vector::Unit(rank, k)).cwiseAbs().maxCoeff(), 1e-11) << k;
    }

    const double smallest = Eigen::JacobiSVD<Matrix>(accepted).singularValues().minCoeff();
    EXPECT_GE(qr.smallest_accepted(), 0.999 * smallest);
    EXPECT_LE(qr.smallest_accepted(), 4 * smallest);
  }
}

// More rows than unknowns: nothing is left free.
TEST(SparseQr, RowsMayFillTheSpace) {
  const Index n = 220, m = 330;
  const Matrix Gt = unit_rows(n, m, true);
  const Index rank = Eigen::ColPivHouseholderQR<Matrix>(Gt).rank();
  SparseQr qr;
  ASSERT_TRUE(qr.factorize(rows_of(Gt), all_of(m), tolerance, Deadline())) << qr.smallest_accepted();
  EXPECT_EQ(std::ssize(qr.order()), rank);
  EXPECT_EQ(std::ssize(qr.rejected()), m - rank);
  Matrix A;
  qr.reduce(rows_of(Gt), all_of(m), A);
  EXPECT_EQ(A.rows(), n - rank);
  for (const Index j : qr.rejected()) EXPECT_LE(A.col(j).norm(), 1e-13) << j;
}

TEST(SparseQr, RowsThatAreNotClearlyIndependentAreRefused) {
  const Index n = 400, m = 200;
  Matrix Gt = unit_rows(n, m, false);
  for (const double apart : {1e-4, 1e-7, 1e-10}) {
    Gt.col(7) = Gt.col(120);
    Index at = 0;
    (Gt.col(7).cwiseAbs().array() == 0).maxCoeff(&at);
    Gt(at, 7) = apart;
    Gt.col(7).normalize();
    SparseQr qr;
    EXPECT_EQ(qr.factorize(rows_of(Gt), all_of(m), tolerance, Deadline()), apart > 1e-6) << apart;
    EXPECT_EQ(qr.holds(), apart > 1e-6) << apart;
  }
}

TEST(SparseQr, WhatDoesNotPayIsRefused) {
  SparseQr qr;
  EXPECT_FALSE(qr.factorize(rows_of(unit_rows(60, 30, false)), all_of(30), tolerance, Deadline()));
  EXPECT_FALSE(qr.factorize(rows_of(unit_rows(400, 8, false)), all_of(8), tolerance, Deadline()));
  std::srand(1);
  EXPECT_FALSE(
      qr.factorize(rows_of(Matrix::Random(400, 200).colwise().normalized()), all_of(200), tolerance, Deadline()));
  EXPECT_THROW(qr.factorize(rows_of(unit_rows(400, 200, false)), all_of(200), tolerance, Deadline(0)), Stopped);
}

// One analysis for other numbers in the same places; another for other places; none in a copy.
TEST(SparseQr, OneObjectDoesAsANewOne) {
  const Index n = 300, m = 120;
  const Matrix first = unit_rows(n, m, true, 1), other = unit_rows(n, m, true, 2);
  const Matrix scaled = (first.array() * (1 + 0.25 * Matrix::Identity(n, m).array())).matrix().colwise().normalized();
  SparseQr kept;
  for (const Matrix& Gt : {first, scaled, other, first}) {
    SparseQr fresh, copy(kept);
    for (SparseQr* qr : {&kept, &fresh, &copy})
      ASSERT_TRUE(qr->factorize(rows_of(Gt), all_of(m), tolerance, Deadline()));
    Vector a = Vector::LinSpaced(n, 0, 1), b = a, c = a;
    kept.rotate(a);
    fresh.rotate(b);
    copy.rotate(c);
    EXPECT_EQ(a, b);
    EXPECT_EQ(a, c);
    EXPECT_EQ(kept.order(), fresh.order());
  }
}

// Neither the library nor what surrounds it, once its memory is there.
TEST(SparseQr, AllocatesNothingWhenItDoesTheSameAgain) {
  const Index n = 400, m = 200;
  const Matrix Gt = unit_rows(n, m, true);
  const SparseQr::Rows G = rows_of(Gt);
  const std::vector<Index> rows = all_of(m);
  SparseQr qr;
  Matrix A;
  Vector x = Vector::Ones(n), w;
  const auto all = [&] {
    ASSERT_TRUE(qr.factorize(G, rows, tolerance, Deadline()));
    qr.rotate(x);
    qr.reduce(G, rows, A);
    w.setOnes(std::ssize(qr.order()));
    qr.solve(w);
    qr.solve_transposed(w);
  };
  for (int warm_up = 0; warm_up < 3; ++warm_up) all();
  const long before = allocations();
  all();
  EXPECT_EQ(allocations() - before, 0);

  const Problem p = make_scenes("random(n=301,m=260,equalities=.7)").at(0).problem;
  AnySolver solver = make_solver("dual_active_set");
  Solution s;
  for (int warm_up = 0; warm_up < 3; ++warm_up) solver.solve(p, {}, s);
  const long before_solve = allocations();
  solver.solve(p, {}, s);
  EXPECT_EQ(allocations() - before_solve, 0);
}

class SparseRows : public testing::TestWithParam<const char*> {};

TEST_P(SparseRows, GiveTheMotionOfTheReflections) {
  AnySolver sparse = make_solver("dual_active_set"), dense = make_solver("dual_active_set:reduce=off");
  for (int seed = 1; seed <= 4; ++seed) {
    const std::string scene = std::string("random(") + GetParam() + ",seed=" + std::to_string(seed) + ")";
    const Problem p = make_scenes(scene).at(0).problem;
    const Solution a = sparse.solve(p), b = dense.solve(p);
    ASSERT_EQ(a.status, b.status) << scene;
    ASSERT_EQ(a.status, Status::solved) << scene;
    const Vector apart = a.z - b.z, moved = b.z - p.z_u;
    EXPECT_LE(std::sqrt(apart.dot(p.M * apart)), 1e-12 * std::sqrt(moved.dot(p.M * moved))) << scene;
    EXPECT_EQ(a.margins.rank, b.margins.rank) << scene;
    const auto dropped = [&](const Solution& s) {
      return std::ranges::count_if(s.redundant, [&](Index i) { return p.is_equality(i); });
    };
    EXPECT_EQ(dropped(a), dropped(b)) << scene;
    if (seed == 1) {
      EXPECT_LE(measure(p, a, nullptr, 1e-10).stationarity, 1e-13) << scene;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Random, SparseRows,
                         testing::Values("n=301,m=260,equalities=.7", "n=301,m=260,equalities=.7,redundancy=0",
                                         "n=401,m=200,equalities=.9,entries=3", "n=253,m=300,equalities=.6,entries=8",
                                         "n=301,m=260,equalities=.7,condition=40"),
                         [](const auto& info) { return "case" + std::to_string(info.index); });

// c of one dropped row moved: no motion meets it, and the proof uses the rows it is made of.
TEST(SparseRows, ContradictionAmongThemIsProven) {
  Problem p = make_scenes("random(n=301,m=260,equalities=.7)").at(0).problem;
  AnySolver solver = make_solver("dual_active_set");
  const Solution feasible = solver.solve(p);
  ASSERT_FALSE(feasible.redundant.empty());
  const Index row = feasible.redundant.front();
  ASSERT_TRUE(p.is_equality(row));
  p.c[row] += 1;
  const Solution contradicted = solver.solve(p);
  EXPECT_EQ(contradicted.status, Status::infeasible);
  EXPECT_NE(contradicted.certificate[row], 0);
  EXPECT_EQ(measure(p, contradicted, nullptr, 1e-10).verdict, Verdict::infeasible_proven);
}

}  // namespace
}  // namespace zwang
