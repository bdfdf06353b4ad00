// Problems as outside files bring them: not dyadic, units mixed, rows repeated, more rows than unknowns. The three
// active-set methods must be right to 1e-9 in the relative M-norm; truth is a solve in 100 digits.
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

struct Recipe {
  const char* name;
  int bodies = 6;
  double rows = 1;         // per unknown
  double equalities = .2;  // fraction of the rows; those are integers, so that J z0 = c holds exactly
  double repeated = 0;   // fraction of the rows that repeat an earlier one, equality rows to the letter and times 1024,
                         // inequality rows times 1000 and rounded
  double decades = 1;    // of the masses
  double touching = .5;  // fraction of the inequality rows that z0 meets without slack
  bool coupled = false;  // M couples bodies (reduced coordinates)
};

Eigen::SparseMatrix<double> mass_matrix(const Recipe& recipe, Draw& draw) {
  const Index n = 6 * recipe.bodies;
  Matrix M = Matrix::Zero(n, n);
  for (Index b = 0; b < recipe.bodies; ++b) {
    Mat<double, 6, 6> root;
    for (double& a : root.reshaped()) a = draw.uniform(-1, 1);
    const double mass = std::pow(10, draw.uniform(0, recipe.decades));
    M.block<6, 6>(6 * b, 6 * b) = mass * (root * root.transpose() + .1 * Mat<double, 6, 6>::Identity());
  }
  if (recipe.coupled)
    for (Index k = 0; k < n; ++k) {
      Vector link = Vector::Zero(n);
      for (int entry = 0; entry < 3; ++entry) link[draw.below(static_cast<int>(n))] = draw.uniform(-1, 1);
      M += link * link.transpose();
    }
  return Matrix(M.selfadjointView<Eigen::Lower>()).sparseView();
}

// Rows over one or two bodies, feasible by construction: z0 meets them all, and a step along `inward` from there enters
// every inequality row, so that rounding makes none infeasible.
Problem random_bodies(const Recipe& recipe, int seed) {
  Draw draw(seed);
  const Index n = 6 * recipe.bodies, m = static_cast<Index>(recipe.rows * static_cast<double>(n));
  const auto equalities = static_cast<Index>(recipe.equalities * static_cast<double>(m));
  Problem p{.name = std::string(recipe.name) + " " + std::to_string(seed), .M = mass_matrix(recipe, draw)};
  Vector z0(n), inward(n);
  for (double& a : z0) a = draw.below(9) - 4;
  for (double& a : inward) a = draw.uniform(-1, 1);
  Matrix J = Matrix::Zero(m, n);
  Vector push = Vector::Zero(m);
  p.c.resize(m);
  for (Index i = 0; i < m; ++i) {
    const bool equality = i < equalities;
    p.kind.push_back(equality ? RowKind::equality : RowKind::inequality);
    p.key.push_back({static_cast<std::uint64_t>(i) + 1, 0});
    const Index first = equality ? 0 : equalities;
    if (i > first && draw.uniform(0, 1) < recipe.repeated) {
      const Index earlier = first + draw.below(static_cast<int>(i - first));
      const double factor = draw.below(2) ? 1 : equality ? 1024 : 1000;
      J.row(i) = factor * J.row(earlier);
      p.c[i] = factor * p.c[earlier];
      continue;
    }
    for (int body = draw.below(2); body < 2; ++body) {
      const Index at = 6 * draw.below(recipe.bodies);
      for (Index k = 0; k < 6; ++k) J(i, at + k) = equality ? draw.below(9) - 4 : draw.uniform(-1, 1);
    }
    if (!equality && J.row(i).dot(inward) < 0) J.row(i) *= -1;
    p.c[i] = J.row(i).dot(z0);
    if (!equality && draw.uniform(0, 1) >= recipe.touching) p.c[i] -= draw.uniform(0, 2);
    push[i] = draw.uniform(equality ? -1 : 0, 1);
  }
  p.J = J.sparseView();
  p.z_u = z0 - Vector(Matrix(p.M).llt().solve(J.transpose() * push));
  for (double& a : p.z_u) a += draw.uniform(-.1, .1);
  return p;
}

void expect_right(const Problem& p) {
  const auto truth = multiprecision_reference(p);
  ASSERT_TRUE(truth && truth->feasible) << p.name;
  for (const char* solver : {"nnls", "cholesky", "dual_active_set"}) {
    const Solution s = make_solver(solver).solve(p);
    EXPECT_EQ(s.status, Status::solved) << solver << ", " << p.name << ": " << s.message;
    EXPECT_LE(relative_distance(p, truth->z, s.z), 1e-9) << solver << ", " << p.name;
  }
}

TEST(OutsideProblems, RandomBodiesAreRightToNineDigits) {
  const Recipe recipes[] = {
      {.name = "bodies"},
      {.name = "one body, many contacts", .bodies = 1, .rows = 20, .equalities = 0},
      {.name = "many rows", .bodies = 4, .rows = 8, .equalities = .02},
      {.name = "all touching", .rows = 3, .equalities = .1, .touching = 1},
      {.name = "repeated rows", .rows = 2, .repeated = .5},
      {.name = "six decades of mass", .rows = 1.5, .decades = 6},
      {.name = "coupled masses", .rows = 1.5, .coupled = true},
      {.name = "coupled masses, six decades, repeated rows", .rows = 2, .repeated = .3, .decades = 6, .coupled = true},
      {.name = "equalities alone", .rows = .8, .equalities = 1, .decades = 6},
      {.name = "more equalities than unknowns", .bodies = 3, .rows = 2, .equalities = 1, .repeated = .2},
      {.name = "equalities that leave nothing free", .bodies = 3, .rows = 4, .equalities = .5, .decades = 4},
      {.name = "no rows", .rows = 0},
  };
  for (const Recipe& recipe : recipes)
    for (int seed = 1; seed <= 6; ++seed) expect_right(random_bodies(recipe, seed));
}

TEST(OutsideProblems, HandsAndTowersAreRightToNineDigits) {
  for (const Instance& instance :
       make_scenes("hand(contacts=4,64,200,seed=1..2),tower(boxes=10,20,30),stack(boxes=10,30,seed=1..2)"))
    expect_right(instance.problem);
}

}  // namespace
}  // namespace zwang
