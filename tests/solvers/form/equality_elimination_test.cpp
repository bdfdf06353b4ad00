// The elimination of equality rows, against its definitions on the rows themselves.
#include <zwang/solvers/form/equality_elimination.h>

#include <gtest/gtest.h>

#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/form/whiten.h>

namespace zwang {
namespace {

constexpr double rounding = 1e-12;

class Elimination : public testing::TestWithParam<bool> {  // whether a sparse QR comes first
 protected:
  void SetUp() override {
    const Problem problem = make_scenes("random(n=60,m=50,equalities=.5,redundancy=.3,seed=5)").at(0).problem;
    ASSERT_TRUE(w_.build(problem));
    for (Index i = 0; i < w_.rows(); ++i) (w_.equality[at(i)] ? equalities_ : others_).push_back(i);
    elimination_.factorize(w_.G, equalities_, rounding, Deadline(), GetParam());
    ASSERT_GT(elimination_.rank(), 10);
    ASSERT_GT(elimination_.freedom(), 10);
  }
  Vector random(Index n) {
    return Vector::NullaryExpr(n, [&] { return std::uniform_real_distribution<double>(-1, 1)(generator_); });
  }
  Vector padded(const Vector& y) const {
    Vector x = Vector::Zero(elimination_.padded_size());
    x.head(y.size()) = y;
    return x;
  }
  // N v.
  Vector lifted(const Vector& v) const {
    Vector x = Vector::Zero(elimination_.padded_size());
    elimination_.join(Vector::Zero(elimination_.rank()), v, x);
    return x;
  }

  Whitened w_;
  std::vector<Index> equalities_, others_;
  EqualityElimination elimination_;
  std::mt19937 generator_{11};
};

TEST_P(Elimination, RotatingBackUndoesARotationAndPartsJoinToTheWhole) {
  const Vector y = padded(random(w_.size()));
  Vector x = y;
  elimination_.rotate(x);
  EXPECT_NEAR(x.norm(), y.norm(), rounding);
  Vector w(elimination_.rank()), v(elimination_.freedom()), joined = Vector::Zero(x.size());
  elimination_.range(x, w);
  elimination_.free(x, v);
  elimination_.join(w, v, joined);
  elimination_.rotate_back(x);
  EXPECT_EQ(joined, x);
  EXPECT_LE((x - y).norm(), rounding);
}

TEST_P(Elimination, WhatIsLiftedMeetsNoEqualityRow) {
  const Vector v = random(elimination_.freedom()), x = lifted(v);
  EXPECT_NEAR(x.norm(), v.norm(), rounding);
  for (const Index i : equalities_) EXPECT_NEAR(w_.dot(i, x), 0, rounding) << i;
}

TEST_P(Elimination, ReducedRowsAreThoseOfWhatIsLifted) {
  Matrix A;
  elimination_.reduce(w_.G, others_, Deadline(), A);
  const Vector v = random(elimination_.freedom()), x = lifted(v);
  for (std::size_t j = 0; j < others_.size(); ++j)
    EXPECT_NEAR(A.col(static_cast<Index>(j)).dot(v), w_.dot(others_[j], x), rounding) << j;
}

TEST_P(Elimination, ItsTriangleGivesTheMultipliersOfACombinationOfRows) {
  const Vector t = random(elimination_.rank());
  Vector x = padded(Vector::Zero(w_.size())), w(t.size());
  for (Index k = 0; k < t.size(); ++k) w_.add(equalities_[at(elimination_.order()[at(k)])], t[k], x);
  elimination_.rotate(x);
  elimination_.range(x, w);
  elimination_.solve(w);
  EXPECT_LE((w - t).norm(), rounding / elimination_.smallest_accepted());
}

INSTANTIATE_TEST_SUITE_P(Form, Elimination, testing::Bool(),
                         [](const auto& i) { return i.param ? "sparse_first" : "reflections"; });

}  // namespace
}  // namespace zwang
