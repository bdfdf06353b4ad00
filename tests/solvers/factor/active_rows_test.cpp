// The factors of the active rows, as rows come and go: against the definitions, on the rows themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/factor/cholesky_rows.h>
#include <zwang/solvers/factor/eliminated_rows.h>

namespace zwang {
namespace {

template <class Rows>
class ActiveRowsOf : public testing::Test {
 protected:
  void SetUp() override {
    problem_ = make_scenes("random(n=40,m=50,equalities=.4,redundancy=0,seed=3)").at(0).problem;
    ASSERT_TRUE(w_.build(problem_));
    rows_.reset(w_, deadline_);
    for (Index i = 0; i < w_.rows(); ++i)
      if (w_.equality[at(i)] && !contains(i)) rows_.append(i);
    equalities_ = rows_.size();
  }

  bool contains(Index row) const { return std::ranges::find(rows_.rows(), row) != rows_.rows().end(); }
  Vector random(Index n) {
    return Vector::NullaryExpr(n, [&] { return std::uniform_real_distribution<double>(-1, 1)(generator_); });
  }
  // Rows enter until `most` are active; then every third inequality row leaves.
  void come_and_go(Index most) {
    for (Index i = 0; i < w_.rows() && rows_.size() < most; ++i)
      if (!w_.equality[at(i)] && !contains(i)) rows_.append(i);
    for (Index k = rows_.size(); k-- > equalities_;)
      if (k % 3 == 0) rows_.drop(k);
  }
  Matrix active() const {
    Matrix G(rows_.size(), w_.size());
    for (Index k = 0; k < rows_.size(); ++k) G.row(k) = Vector(w_.G.row(rows_[k]));
    return G;
  }

  static constexpr double rounding = 1e-12;
  Problem problem_;
  Whitened w_;
  Deadline deadline_;
  Rows rows_;
  Index equalities_ = 0;
  std::mt19937 generator_{7};
};

using Kinds = testing::Types<QrRows, EliminatedRows, CholeskyRows>;
TYPED_TEST_SUITE(ActiveRowsOf, Kinds);

TYPED_TEST(ActiveRowsOf, CombineLeavesWhatIsOrthogonalToAllRows) {
  for (const Index most : {25, 30, 36}) {
    this->come_and_go(most);
    const Matrix G = this->active();
    ASSERT_GT(G.rows(), this->equalities_);
    const Vector given = this->random(G.cols());
    Vector v = given, t(G.rows());
    this->rows_.combine(v, t);
    EXPECT_LE((G * v).norm(), this->rounding);
    EXPECT_LE((G.transpose() * t + v - given).norm(), this->rounding);
  }
}

TYPED_TEST(ActiveRowsOf, CorrectSolvesForMotionAndMultipliers) {
  for (const Index most : {25, 30, 36}) {
    this->come_and_go(most);
    const Matrix G = this->active();
    const Vector rho = this->random(G.cols()), sigma = this->random(G.rows());
    Vector dy = rho, dl = sigma;
    this->rows_.correct(dy, dl);
    EXPECT_LE((dy - G.transpose() * dl - rho).norm(), this->rounding * (1 + dl.norm()));
    EXPECT_LE((G * dy - sigma).norm(), this->rounding * (1 + dy.norm()));
  }
}

TYPED_TEST(ActiveRowsOf, AShareIsTheLengthOutsideTheOthers) {
  this->come_and_go(36);
  const Matrix G = this->active();
  for (Index i = 0; i < this->w_.rows(); ++i) {
    if (this->contains(i)) continue;
    const Vector g = this->w_.G.row(i);
    const Vector rest = g - G.transpose() * G.transpose().colPivHouseholderQr().solve(g);
    EXPECT_NEAR(this->rows_.share(i), rest.norm(), this->rounding) << i;
  }
  // A row that is active has nothing left.
  Vector v = G.row(0), t(G.rows());
  this->rows_.combine(v, t);
  EXPECT_LE(v.norm(), this->rounding);
  EXPECT_LE((t - Vector::Unit(G.rows(), 0)).norm(), this->rounding);
}

// Equality rows by a sparse QR, which takes many columns at once: redundant rows, and any motion beside them.
TEST(EliminatedRows, CombinesManyColumnsAtOnce) {
  const Problem p = make_scenes("random(n=300,m=180,equalities=.8,seed=3)").at(0).problem;
  const Deadline deadline;
  Whitened w;
  ASSERT_TRUE(w.build(p));
  EliminatedRows rows;
  rows.sparse = true;
  rows.reset(w, deadline);
  ASSERT_GT(rows.together(), 1);
  for (const Index i : rows.inequalities()) rows.append(i);
  ASSERT_GT(rows.size(), rows.rank());
  const Index redundant = std::ssize(rows.rejected()), count = redundant + 3;
  ASSERT_GT(redundant, 5);
  ASSERT_LE(count, rows.together());
  Matrix V = Matrix::Random(300, count), T(rows.size(), count), G(rows.size(), 300);
  for (Index c = 0; c < redundant; ++c) V.col(c) = Vector(w.G.row(rows.rejected()[at(c)]));
  for (Index k = 0; k < rows.size(); ++k) G.row(k) = Vector(w.G.row(rows[k]));
  const Matrix given = V;
  rows.combine(V, T);
  EXPECT_LE((G * V).norm(), 1e-12);
  EXPECT_LE((G.transpose() * T + V - given).norm(), 1e-12);
  EXPECT_LE(V.leftCols(redundant).norm(), 1e-12);
  EXPECT_GT(V.rightCols(3).norm(), 1);
}

}  // namespace
}  // namespace zwang
