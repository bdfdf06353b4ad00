// The reduced form of jointed bodies, and dual_active_set on it against its careful path, over random mechanisms.
#include "solvers/reduced_form.h"

#include <gtest/gtest.h>

#include <random>

#include "core/measure.h"
#include "solvers/dual_active_set.h"
#include "bench/suite/allocations.h"

namespace zwang {
namespace {

enum class Graph { floating_tree, grounded_tree, loops, welds, redundant_joints };
constexpr Graph graphs[] = {Graph::floating_tree, Graph::grounded_tree, Graph::loops, Graph::welds,
                            Graph::redundant_joints};

// Bodies with full random inertia, joints of random rows over random pairs, rows on one or two bodies pressed against.
// Masses spread by exp(spread N(0, 1)). Feasible: every c is met by one random motion.
Problem random_mechanism(Graph graph, unsigned seed, double spread = 2) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto uniform = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most)); };
  const int bodies = 2 + uniform(9), n = 6 * bodies;
  std::vector<Eigen::Triplet<double>> M, J;
  for (int b = 0; b < bodies; ++b) {
    const Mat<double, 6, 6> A = Mat<double, 6, 6>::NullaryExpr([&] { return normal(random); });
    const Mat<double, 6, 6> block =
        std::exp(spread * normal(random)) * (A * A.transpose() + Mat<double, 6, 6>::Identity());
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) M.emplace_back(6 * b + i, 6 * b + j, block(i, j));
  }
  Problem p;
  std::vector<RowKind>& kind = p.kind;
  const auto add_row = [&](int a, int b, RowKind type) {
    const int row = static_cast<int>(kind.size());
    for (const int body : {std::min(a, b), std::max(a, b)})
      for (int i = 0; i < 6 && body >= 0; ++i) J.emplace_back(row, 6 * body + i, normal(random));
    kind.push_back(type);
  };
  const auto add_joint = [&](int a, int b, int rows) {
    for (int k = 0; k < rows; ++k) add_row(a, b, RowKind::equality);
  };
  if (graph == Graph::grounded_tree) add_joint(0, -1, 1 + uniform(6));
  for (int b = 1; b < bodies; ++b) add_joint(uniform(b), b, graph == Graph::welds ? 6 : 1 + uniform(5));
  if (graph == Graph::loops)
    for (int k = 0; k < 2; ++k)
      if (const int a = uniform(bodies), b = uniform(bodies); a != b) add_joint(a, b, 1 + uniform(2));
  const int contacts = uniform(4 * bodies);
  for (int k = 0; k < contacts; ++k) add_row(uniform(bodies), uniform(3) ? -1 : uniform(bodies), RowKind::inequality);
  const int given = static_cast<int>(kind.size());
  const int copied = graph == Graph::redundant_joints ? 1 + uniform(3) : 0;
  std::vector<Eigen::Triplet<double>> copies;
  for (int k = 0; k < copied; ++k) {
    const int from = uniform(bodies - 1);
    for (const auto& entry : J)
      if (entry.row() == from) copies.emplace_back(given + k, entry.col(), 2 * entry.value());
    kind.push_back(RowKind::equality);
  }
  J.insert(J.end(), copies.begin(), copies.end());
  const auto m = static_cast<Index>(kind.size());
  p.name = "mechanism " + std::to_string(seed);
  p.M.resize(n, n);
  p.M.setFromTriplets(M.begin(), M.end());
  p.J.resize(m, n);
  p.J.setFromTriplets(J.begin(), J.end());  // a contact of a body with itself becomes one row of sums
  p.z_u = Vector::NullaryExpr(n, [&] { return normal(random); });
  const Vector z = Vector::NullaryExpr(n, [&] { return normal(random); });
  p.c = p.J * z;
  for (Index i = 0; i < m; ++i) {
    p.key.push_back({static_cast<std::uint64_t>(i), 0});
    if (!p.is_equality(i) && uniform(2)) p.c[i] -= std::abs(normal(random));
  }
  for (int k = 0; k < copied; ++k) {
    Index from = 0;
    for (Index i = 0; i < given; ++i)
      if ((2 * p.J.row(i) - p.J.row(given + k)).norm() == 0) from = i;
    p.c[given + k] = 2 * p.c[from];
  }
  return p;
}

double distance(const Problem& p, const Vector& a, const Vector& b) {
  return std::sqrt((a - b).dot(p.M * (a - b))) / std::sqrt(p.z_u.dot(p.M * p.z_u));
}

// N is orthonormal and free of the joints; shift and multipliers solve the two systems they promise to.
TEST(ReducedForm, SpansTheFreeMotionsOfRandomMechanisms) {
  for (const Graph graph : graphs) {
    int reduced = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
      const Problem p = random_mechanism(graph, seed, 0.5);
      ReducedForm form;
      if (!form.build(p)) {
        EXPECT_FALSE(form.reason().empty());
        continue;
      }
      ++reduced;
      const Index f = form.freedom(), rows = static_cast<Index>(form.equalities().size());
      const double precision = 1e-12 / form.smallest_pivot();  // digits go joint by joint along a chain
      ReducedForm::Motion y(8, p.size() / 6), other(8, p.size() / 6);
      Vector v(f), back(f);
      for (Index k = 0; k < f; ++k) {
        form.expand(v = Vector::Unit(f, k), y);
        for (const Index i : form.equalities()) EXPECT_NEAR(form.rows().dot(i, y), 0, precision) << seed;
        form.reduce(y, back);
        EXPECT_LE((back - v).norm(), precision) << seed;
      }
      EXPECT_EQ(f + rows, p.size());
      const Vector sigma = Vector::LinSpaced(rows, -1, 1);
      form.shift(sigma, y);
      form.reduce(y, back);
      EXPECT_LE(back.norm(), precision * (1 + y.norm())) << seed;
      other.setZero();
      for (Index k = 0; k < rows; ++k) {
        const Index i = form.equalities()[static_cast<std::size_t>(k)];
        EXPECT_NEAR(form.rows().dot(i, y), sigma[k], precision * (1 + y.norm())) << seed;
        form.rows().add(i, sigma[k], other);
      }
      Vector mu(rows);
      form.multipliers(other, mu);
      EXPECT_LE((mu - sigma).norm(), precision * rows / form.smallest_pivot()) << seed;
    }
    EXPECT_GE(reduced, graph == Graph::redundant_joints ? 0 : 180) << static_cast<int>(graph);
  }
}

TEST(ReducedForm, GivesTheMotionOfTheCarefulPathOnRandomMechanisms) {
  for (const Graph graph : graphs) {
    int compared = 0;
    for (unsigned seed = 0; seed < 300; ++seed) {
      const Problem p = random_mechanism(graph, seed);
      DualActiveSet fast, careful;
      careful.reduce = false;
      Solution a, b;
      fast.solve(p, {}, a);
      careful.solve(p, {}, b);
      ASSERT_EQ(a.status, b.status) << p.name;
      if (b.status != Status::solved || b.margins.smallest_accepted < 1e-6) continue;
      ++compared;
      EXPECT_LE(distance(p, a.z, b.z), 1e-12) << p.name;
      const Metrics metrics = measure(p, a, nullptr, 1e-10);
      const Metrics other = measure(p, b, nullptr, 1e-10);  // large multipliers of nearly dependent joints round alike
      EXPECT_LE(metrics.stationarity, 1e-13 + 10 * other.stationarity) << p.name;
      EXPECT_LE(metrics.primal, 1e-13 + 10 * other.primal) << p.name;
    }
    EXPECT_GE(compared, 280) << static_cast<int>(graph);
  }
}

TEST(ReducedForm, LetsWarmStartsFindTheDigitsOfColdOnes) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Problem p = random_mechanism(Graph::floating_tree, seed);
    DualActiveSet solver;
    Solution cold, warm;
    solver.solve(p, {}, cold);
    const WarmStart start{p.key, cold.lambda};
    solver.solve(p, {.warm_start = &start}, warm);
    EXPECT_EQ(warm.iterations, 0) << p.name;
    EXPECT_LE(distance(p, warm.z, cold.z), 1e-15) << p.name;
  }
}

TEST(ReducedForm, AllocatesNothingInASecondSolveOfTheSameShape) {
  for (const Graph graph : {Graph::floating_tree, Graph::grounded_tree, Graph::loops}) {
    const Problem p = random_mechanism(graph, 5);
    ReducedActiveSet solver;
    Solution s;
    s.reset(p.size(), p.rows());
    ASSERT_TRUE(solver.solve(p, {}, s)) << solver.reason();
    s.reset(p.size(), p.rows());
    const long before = allocations();
    ASSERT_TRUE(solver.solve(p, {}, s));
    EXPECT_EQ(allocations() - before, 0);
  }
}

// Two mechanisms side by side are solved apart, and as each alone.
TEST(ReducedForm, SolvesIslandsApart) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Problem a = random_mechanism(Graph::floating_tree, seed), b = random_mechanism(Graph::loops, seed + 1);
    Problem both;
    const Index n = a.size() + b.size(), m = a.rows() + b.rows();
    std::vector<Eigen::Triplet<double>> M, J;
    for (const auto& [part, row, column] : {std::tuple{&a, Index{0}, Index{0}}, std::tuple{&b, a.rows(), a.size()}}) {
      for (Index j = 0; j < part->size(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator it(part->M, j); it; ++it)
          M.emplace_back(column + it.row(), column + j, it.value());
      for (Index i = 0; i < part->rows(); ++i)
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(part->J, i); it; ++it)
          J.emplace_back(row + i, column + it.col(), it.value());
      both.kind.insert(both.kind.end(), part->kind.begin(), part->kind.end());
      both.key.insert(both.key.end(), part->key.begin(), part->key.end());
    }
    both.M.resize(n, n);
    both.M.setFromTriplets(M.begin(), M.end());
    both.J.resize(m, n);
    both.J.setFromTriplets(J.begin(), J.end());
    both.z_u.resize(n);
    both.z_u << a.z_u, b.z_u;
    both.c.resize(m);
    both.c << a.c, b.c;
    DualActiveSet solver;
    Solution whole, left, right;
    solver.solve(both, {}, whole);
    solver.solve(a, {}, left);
    solver.solve(b, {}, right);
    ASSERT_EQ(whole.z.size(), n) << seed;
    EXPECT_EQ(whole.z.head(a.size()), left.z) << seed;
    EXPECT_EQ(whole.z.tail(b.size()), right.z) << seed;
  }
}

}  // namespace
}  // namespace zwang
