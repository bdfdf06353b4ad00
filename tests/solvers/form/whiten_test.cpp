// The one whitening and its views, against dense factors in long double. Q is not unique, so what is compared does not
// depend on it: norms, G G' and the motions.
#include <zwang/solvers/form/whiten.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/form/body_rows.h>
#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/form/unit_rows.h>

namespace zwang {
namespace {

using Real = long double;
using RealVector = VectorX<Real>;
using RealMatrix = MatrixX<Real>;

enum class Mass { diagonal, bodies, coupled };

// Rows of up to three entries on one or two of the bodies; the first third are equality rows.
Problem random_problem(Mass mass, Index bodies, Index rows, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto below = [&](Index most) { return static_cast<Index>(random() % static_cast<unsigned>(most)); };
  const Index n = 6 * bodies;
  Matrix M = Matrix::Zero(n, n);
  for (Index b = 0; b < bodies; ++b) {
    Mat<double, 6, 6> L = Mat<double, 6, 6>::NullaryExpr([&](Index, Index) { return normal(random); });
    Mat<double, 6, 6> block = L * L.transpose() + Mat<double, 6, 6>::Identity();
    if (mass == Mass::diagonal) block = Mat<double, 6, 6>(block.diagonal().asDiagonal());
    M.block<6, 6>(6 * b, 6 * b) = std::exp(normal(random)) * block;
  }
  if (mass == Mass::coupled)
    for (Index b = 0; b + 1 < bodies; b += 2) M(6 * b, 6 * b + 6) = M(6 * b + 6, 6 * b) = 0.01;
  Matrix J = Matrix::Zero(rows, n);
  for (Index i = 0; i < rows; ++i)
    for (int part = 0; part < 2; ++part) {
      const Index b = below(bodies);
      for (int entry = 0; entry < 3; ++entry) J(i, 6 * b + below(6)) = normal(random);
    }
  Problem p;
  p.M = M.sparseView();
  p.J = J.sparseView();
  p.z_u = Vector::NullaryExpr(n, [&] { return 3 * normal(random); });
  p.c = Vector::NullaryExpr(rows, [&] { return normal(random); });
  p.kind.assign(static_cast<std::size_t>(rows), RowKind::inequality);
  std::fill_n(p.kind.begin(), rows / 3, RowKind::equality);
  p.key.resize(p.kind.size());
  return p;
}

// What a whitening has to find, dense.
struct Truth {
  explicit Truth(const Problem& p)
      : J(Matrix(p.J).cast<Real>()),
        M(Matrix(p.M).cast<Real>()),
        S(J * M.llt().solve(RealMatrix(J.transpose()))),
        norm(S.diagonal().cwiseSqrt()),
        violation((p.c.cast<Real>() - J * p.z_u.cast<Real>()).cwiseQuotient(norm)),
        free(std::sqrt(p.z_u.cast<Real>().dot(M * p.z_u.cast<Real>()))) {}
  RealMatrix J, M, S;
  RealVector norm, violation;  // of the unit rows, at z_u
  Real free;
};

class Whitening : public testing::TestWithParam<Mass> {};

TEST_P(Whitening, RowsAreThoseOfADenseFactorInLongDouble) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Problem p = random_problem(GetParam(), 2 + seed % 7, 5 + 3 * static_cast<Index>(seed), seed);
    const Truth truth(p);
    Whitened w;
    ASSERT_TRUE(w.build(p));
    ASSERT_EQ(w.rows(), p.rows());
    const Real unit = std::ldexp(1.0L, w.exponent);
    const RealMatrix G = Matrix(w.G).cast<Real>();
    const RealMatrix S = truth.norm.asDiagonal().inverse() * truth.S * truth.norm.asDiagonal().inverse();
    EXPECT_LE((G * G.transpose() - S).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LE((w.row_norm.cast<Real>() - truth.norm).cwiseQuotient(truth.norm).cwiseAbs().maxCoeff(), 1e-14);
    const RealVector off = w.h.cast<Real>() - truth.violation / unit;
    EXPECT_LE(off.cwiseQuotient(w.magnitude.cast<Real>()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LE(std::abs(unit * w.free.norm() - truth.free), 1e-14 * truth.free);
    double worst = 0;
    for (Index i = 0; i < w.rows(); ++i) {
      worst = std::max(worst, p.is_equality(i) ? std::abs(w.h[i]) : w.h[i]);
      EXPECT_NEAR(w.magnitude[i], static_cast<double>(std::abs(p.c[i]) / truth.norm[i] / unit) + w.free.norm(),
                  1e-14 * w.magnitude[i]);
    }
    EXPECT_GE(worst, 0.5);
    EXPECT_LT(worst, 1);

    // A motion and its image: as long, and as far along each row.
    const Vector y = Vector::LinSpaced(p.size(), -1, 2);
    Vector z;
    w.primal(p, y, z);
    const RealVector d = (z.cast<Real>() - p.z_u.cast<Real>()) / unit;
    EXPECT_LE(std::abs(std::sqrt(d.dot(truth.M * d)) - y.norm()), 1e-12);
    EXPECT_LE((truth.J * d - truth.norm.cwiseProduct(G * y.cast<Real>())).cwiseAbs().maxCoeff(), 1e-12);
    Vector unit_lambda = Vector::LinSpaced(p.rows(), 0, 1), lambda;
    w.multipliers(p, unit_lambda, lambda);
    for (Index i = 0; i < p.rows(); ++i) EXPECT_NEAR(w.unit_multiplier(i, lambda[i]), unit_lambda[i], 1e-15);
  }
}

TEST_P(Whitening, RowsHaveEntriesOnlyOnWhatMJoinsToTheirOwn) {
  const Problem p = random_problem(GetParam(), 40, 90, 7);
  Whitened w;
  ASSERT_TRUE(w.build(p));
  for (Index i = 0; i < w.rows(); ++i) {
    const Index own = p.J.row(i).nonZeros(), entries = w.G.row(i).nonZeros();
    EXPECT_GE(entries, own);
    EXPECT_LE(entries, GetParam() == Mass::diagonal ? own : GetParam() == Mass::bodies ? 12 : 24);
    for (Whitened::Rows::InnerIterator it(w.G, i); it; ++it) EXPECT_NE(it.value(), 0);
  }
  Matrix Gt;
  w.dense(Gt);
  EXPECT_EQ(Gt, Matrix(Matrix(w.G).transpose()));
  const Vector y = Vector::LinSpaced(p.size(), -1, 2);
  Vector moved = y;
  w.add(3, 0.5, moved);
  EXPECT_NEAR(w.dot(3, y), Gt.col(3).dot(y), 1e-14);
  EXPECT_LE((moved - y - 0.5 * Gt.col(3)).norm(), 1e-14);
}

// Powers of two are exact: masses by 4^a, rows by 2^b, motions by 2^s.
TEST_P(Whitening, ScaledTwinsHaveTheSameBits) {
  const Problem p = random_problem(GetParam(), 5, 17, 3);
  Whitened plain;
  ASSERT_TRUE(plain.build(p));
  for (const int a : {-150, 0, 150})
    for (const int b : {-300, 0, 300})
      for (const int s : {-300, 0, 300}) {
        Problem twin = p;
        twin.M *= std::ldexp(1.0, 2 * a);
        twin.J *= std::ldexp(1.0, b);
        twin.z_u *= std::ldexp(1.0, s);
        twin.c *= std::ldexp(1.0, b + s);
        Whitened w;
        ASSERT_TRUE(w.build(twin));
        EXPECT_EQ(Matrix(w.G), Matrix(plain.G)) << a << " " << b << " " << s;
        EXPECT_EQ(w.h, plain.h);
        EXPECT_EQ(w.magnitude, plain.magnitude);
        EXPECT_EQ(w.free, plain.free);
        EXPECT_EQ(w.exponent, plain.exponent + a + s);
        EXPECT_EQ(w.row_norm, Vector(std::ldexp(1.0, b - a) * plain.row_norm));
      }
}

// One row or mass of 2^+-300 beside ordinary ones.
TEST_P(Whitening, RowsOfAllSizesStandBesideEachOther) {
  for (const int size : {-300, 300}) {
    Problem p = random_problem(GetParam(), 4, 12, 5);
    const Vector scale = Vector::NullaryExpr(12, [&](Index i) { return i % 2 ? std::ldexp(1.0, size) : 1.0; });
    p.J = Whitened::Rows(scale.asDiagonal() * p.J);
    p.c = scale.cwiseProduct(p.c);
    const Truth truth(p);
    Whitened w;
    ASSERT_TRUE(w.build(p));
    EXPECT_LE((w.row_norm.cast<Real>() - truth.norm).cwiseQuotient(truth.norm).cwiseAbs().maxCoeff(), 1e-14);
    const RealVector off = w.h.cast<Real>() - truth.violation / std::ldexp(1.0L, w.exponent);
    EXPECT_LE(off.cwiseQuotient(w.magnitude.cast<Real>()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST_P(Whitening, SecondBuildOfTheSameShapeAllocatesNothing) {
  const Problem p = random_problem(GetParam(), 12, 40, 9), other = random_problem(GetParam(), 12, 40, 10);
  Whitened w;
  ASSERT_TRUE(w.build(p));
  const long before = allocations();
  ASSERT_TRUE(w.build(p));
  EXPECT_EQ(allocations() - before, 0);
  // Nothing of the problem before is left.
  Whitened fresh;
  ASSERT_TRUE(w.build(other) && fresh.build(other));
  EXPECT_EQ(Matrix(w.G), Matrix(fresh.G));
  EXPECT_EQ(w.h, fresh.h);
}

// The rows over M's own columns are the problem's, and h is what the stored doubles say.
TEST_P(Whitening, RowsOverTheColumnsOfMAreTheProblemsOwn) {
  const Problem p = random_problem(GetParam(), 9, 31, 11);
  const Truth truth(p);
  UnitRows rows;
  ASSERT_TRUE(rows.build(p));
  const Real unit = std::ldexp(1.0L, rows.exponent);
  for (Index i = 0; i < rows.rows(); ++i) {
    RealVector g = RealVector::Zero(p.size());
    for (int e = rows.g.begin[static_cast<std::size_t>(i)]; e < rows.g.begin[static_cast<std::size_t>(i) + 1]; ++e)
      g[rows.g.column[static_cast<std::size_t>(e)]] = rows.g.value[static_cast<std::size_t>(e)];
    EXPECT_LE((g - truth.J.row(i).transpose() / truth.norm[i]).cwiseAbs().maxCoeff(), 1e-13);
    const Real rest = p.c[i] - truth.J.row(i).dot(p.z_u.cast<Real>());
    EXPECT_LE(std::abs(unit * rows.exact_h[i] * rows.row_norm[i] - rest), 1e-17L);
    EXPECT_NEAR(rows.unit_multiplier(i, rows.multiplier(i, 0.3L)), 0.3, 1e-16);
  }
}

// Balls: lever arms crossed with their normals.
TEST(FaintColumns, AreLeftOutOfTheRowsAndWhatTheyPullIsKept) {
  const Problem p = make_scenes("pile(spheres=20)").front().problem;
  UnitRows rows;
  ASSERT_TRUE(rows.build(p));
  for (const int j : rows.g.column) EXPECT_LT(j % 6, 3);
  ASSERT_FALSE(rows.faint.empty());
  for (const UnitRows::Faint& e : rows.faint) {
    EXPECT_GE(e.column % 6, 3);
    EXPECT_NEAR(e.pull * p.M.coeff(e.column, e.column), p.J.coeff(e.row, e.column), 1e-30);
  }
  const Vector lambda = Vector::LinSpaced(p.rows(), 1, 2), force = p.J.transpose() * lambda;
  Vector z = Vector::Zero(p.size());
  rows.move_faint(lambda, z);
  for (const UnitRows::Faint& e : rows.faint)
    EXPECT_NEAR(z[e.column] * p.M.coeff(e.column, e.column), force[e.column], 1e-28);
  // A column that M ties to another stays, and so does one with a single entry above rounding.
  Problem tied = p, turned = p;
  const UnitRows::Faint& first = rows.faint.front();
  const int next = first.column % 6 == 5 ? first.column - 1 : first.column + 1;
  tied.M.coeffRef(first.column, next) = tied.M.coeffRef(next, first.column) = 1e-3 * p.M.coeff(next, next);
  turned.J.coeffRef(first.row, first.column) = 1e-9;
  const auto stays = [](const Problem& own, int column) {
    UnitRows other;
    EXPECT_TRUE(other.build(own));
    return std::ranges::find(other.g.column, column) != other.g.column.end();
  };
  EXPECT_TRUE(stays(tied, first.column));
  EXPECT_TRUE(stays(turned, first.column));
  EXPECT_FALSE(stays(p, first.column));
}

TEST_P(Whitening, ProgramIsTheSameInAnotherUnitOfLength) {
  const Problem p = random_problem(GetParam(), 6, 20, 13);
  Whitened w;
  UnitProgram program;
  Solution s;
  ASSERT_TRUE(w.build(p) && program.build(p, {}, s));
  EXPECT_EQ(Matrix(program.G), Matrix(w.G));
  int exponent = 0;
  const double ratio = program.h[0] / w.h[0];
  EXPECT_EQ(std::frexp(ratio, &exponent), 0.5);
  EXPECT_EQ(program.h, Vector(ratio * w.h));
  EXPECT_GE(program.reach(), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Masses, Whitening, testing::Values(Mass::diagonal, Mass::bodies, Mass::coupled));

// In blocks of six by bodies, with Q of its own: the same norms, violations and products.
TEST(BlockRows, AreTheSameRows) {
  for (const char* scene : {"hand(contacts=24,limits=6)", "tower(boxes=6)"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    Whitened w;
    BodyRows blocks;
    ASSERT_TRUE(w.build(p) && blocks.build(p)) << scene;
    ASSERT_EQ(blocks.row, w.row);
    EXPECT_EQ(blocks.exponent, w.exponent);
    for (Index i = 0; i < w.rows(); ++i) {
      EXPECT_NEAR(blocks.row_norm[i], w.row_norm[i], 1e-14 * w.row_norm[i]);
      EXPECT_NEAR(blocks.h[i], w.h[i], 1e-14 * w.magnitude[i]);
      EXPECT_NEAR(blocks.magnitude[i], w.magnitude[i], 1e-14 * w.magnitude[i]);
    }
    EXPECT_NEAR(blocks.free_norm, w.free.norm(), 1e-14 * w.free.norm());
    BodyRows::Motion y;
    const Matrix S = Matrix(w.G) * Matrix(w.G).transpose();
    for (Index i = 0; i < w.rows(); ++i) {
      y.setZero(BodyRows::lanes, blocks.bodies());
      blocks.add(i, 1, y);
      for (Index j = 0; j < w.rows(); ++j) EXPECT_NEAR(blocks.dot(j, y), S(i, j), 1e-14);
    }
  }
}

TEST(WhitenedRows, ThatCannotMatterAreLeftOut) {
  Problem p = random_problem(Mass::bodies, 2, 6, 1);
  Matrix J(p.J);
  J.row(0).setZero();  // an equality row that holds
  J.row(4).setZero();  // an inequality row that holds
  p.J = J.sparseView();
  p.c[0] = 0;
  p.c[3] = -std::numeric_limits<double>::infinity();
  p.c[4] = -1;
  Whitened w;
  ASSERT_TRUE(w.build(p));
  EXPECT_EQ(w.row, (std::vector<Index>{1, 2, 5}));
  EXPECT_EQ(w.idle, (std::vector<Index>{0, 4}));
  EXPECT_EQ(w.conflict, -1);
  p.c[4] = 1;
  ASSERT_TRUE(w.build(p));
  EXPECT_EQ(w.conflict, 4);
}

TEST(WhitenedRows, ThatMFillsBeyondTheMemoryAreRefused) {
  const Problem p = make_scenes("random(n=120,m=160)").at(0).problem;
  Whitened w;
  EXPECT_THROW(w.build(p, Deadline(), {.memory_limit = 8000}), Stopped);
  EXPECT_TRUE(w.build(p));
  EXPECT_THROW(w.build(p, Deadline(0)), Stopped);
}

}  // namespace
}  // namespace zwang
