// The reduced form of jointed bodies, and dual_active_set on it against its careful path, over random mechanisms.
#include <zwang/solvers/form/null_space_form.h>

#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/random_mechanism.h"

namespace zwang {
namespace {

using test::distance, test::Graph, test::graphs, test::random_mechanism, test::seeds;

// N is orthonormal and free of the joints; shift and multipliers solve the two systems they promise to.
TEST(NullSpaceForm, SpansTheFreeMotionsOfRandomMechanisms) {
  for (const Graph graph : graphs) {
    int reduced = 0;
    for (unsigned seed = 0; seed < seeds(graph, 200); ++seed) {
      const Problem p = random_mechanism(graph, seed, 0.5);
      NullSpaceForm form;
      if (!form.build(p).empty()) continue;
      ++reduced;
      const Index f = form.freedom(), rows = static_cast<Index>(form.equalities().size());
      const double precision = 1e-12 / form.smallest_pivot();  // digits go joint by joint along a chain
      NullSpaceForm::Motion y(8, p.size() / 6), other(8, p.size() / 6);
      Vector v(f), back(f);
      for (Index k = 0; k < f; ++k) {
        form.expand(v = Vector::Unit(f, k), y);
        for (const Index i : form.equalities()) EXPECT_NEAR(form.rows().dot(i, y), 0, precision) << seed;
        form.reduce(y, back);
        EXPECT_LE((back - v).norm(), precision) << seed;
      }
      EXPECT_EQ(f + rows, p.size());
      const Vector sigma = Vector::LinSpaced(rows, -1, 1);
      form.reduce(form.y_E(), back);
      EXPECT_LE(back.norm(), precision * (1 + form.y_E().norm())) << seed;
      form.meet(sigma, y);
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
    EXPECT_GE(reduced, graph == Graph::redundant_joints ? 0 : static_cast<int>(seeds(graph, 180)))
        << static_cast<int>(graph);
  }
}

TEST(NullSpaceForm, GivesTheMotionOfTheCarefulPathOnRandomMechanisms) {
  for (const Graph graph : graphs) {
    int compared = 0;
    for (unsigned seed = 0; seed < seeds(graph, 300); ++seed) {
      const Problem p = random_mechanism(graph, seed);
      DualActiveSet fast, careful;
      careful.reduce = false;
      Solution a, b;
      fast.solve(p, {}, a);
      careful.solve(p, {}, b);
      ASSERT_EQ(a.status, b.status) << p.name;
      // Where joints alone determine a row, rounding in c contradicts them (100 digits agree): that is flagged.
      if (b.status != Status::solved && b.status != Status::solved_ill_conditioned) continue;
      if (b.margins.smallest_accepted < 1e-6) continue;
      ++compared;
      EXPECT_LE(distance(p, a.z, b.z), 1e-12) << p.name;
      const Metrics metrics = measure(p, a, nullptr, 1e-10);
      const Metrics other = measure(p, b, nullptr, 1e-10);  // large multipliers of nearly dependent joints round alike
      EXPECT_LE(metrics.stationarity, 1e-13 + 10 * other.stationarity) << p.name;
      EXPECT_LE(metrics.primal, 1e-13 + 10 * other.primal) << p.name;
    }
    EXPECT_GE(compared, static_cast<int>(seeds(graph, 280))) << static_cast<int>(graph);
  }
}

TEST(NullSpaceForm, LetsWarmStartsFindTheDigitsOfColdOnes) {
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

TEST(NullSpaceForm, AllocatesNothingInASecondSolveOfTheSameShape) {
  for (const Graph graph : {Graph::floating_tree, Graph::grounded_tree, Graph::loops}) {
    const Problem p = random_mechanism(graph, 5);
    JointSpaceActiveSet solver;
    Solution s;
    s.reset(p.size(), p.rows());
    ASSERT_TRUE(solver.solve(p, {}, s)) << solver.reason();
    s.reset(p.size(), p.rows());
    const long before = allocations();
    ASSERT_TRUE(solver.solve(p, {}, s));
    EXPECT_EQ(allocations() - before, 0);
  }
}

// A hand that comes to rest: entries fade to 1e-318, which is nothing beside the others. Where all have faded they are
// the problem.
TEST(NullSpaceForm, TakesEntriesThatHaveFaded) {
  const Problem p = make_scenes("hand(contacts=4)").at(0).problem;
  Problem faded = p, none = p, all = p;
  for (Index i = 0; i < p.size(); i += 5) faded.z_u[i] = 1e-318, none.z_u[i] = 0;
  for (Index i = 0; i < p.rows(); i += 3) faded.c[i] = 1e-110, none.c[i] = 0;
  JointSpaceActiveSet solver;
  Solution a, b;
  a.reset(p.size(), p.rows());
  ASSERT_TRUE(solver.solve(faded, {}, a)) << solver.reason();
  make_solver("dual_active_set").solve(none, {}, b);
  EXPECT_LE(distance(none, a.z, b.z), 1e-15);
  all.z_u *= 1e-310;
  all.c *= 1e-310;
  EXPECT_FALSE(solver.solve(all, {}, a));
}

// What z_u violates rows by may have faded beside z_u, too.
TEST(NullSpaceForm, TakesViolationsThatHaveFaded) {
  Problem p{.name = "one of two bodies"};
  p.M.resize(12, 12);
  p.M.setIdentity();
  p.z_u = Vector::Unit(12, 6);
  p.J.resize(1, 12);
  p.J.insert(0, 0) = 1;
  p.c = Vector::Constant(1, 1e-100);
  p.kind = {RowKind::equality};
  p.key = {{1, 0}};
  JointSpaceActiveSet solver;
  Solution s;
  s.reset(p.size(), p.rows());
  ASSERT_TRUE(solver.solve(p, {}, s)) << solver.reason();
  EXPECT_LE(distance(p, s.z, p.z_u), 1e-15);
}

// A plate slides over a plane on four corners, whose rows depend on each other; that it sinks, and by how much one
// corner is deeper than the others, is less than rounding of the slide, and has to be seen all the same.
TEST(NullSpaceForm, SeesViolationsBelowRoundingInDouble) {
  Problem p{.name = "plate"};
  p.M.resize(6, 6);
  p.M.setIdentity();
  p.J.resize(4, 6);
  for (int k = 0; k < 4; ++k) {
    p.J.insert(k, 2) = 1;
    p.J.insert(k, 3) = k % 2 == 0 ? -1 : 1;
    p.J.insert(k, 4) = k / 2 == 0 ? -1 : 1;
  }
  p.c.resize(4);
  p.kind.assign(4, RowKind::inequality);
  p.key = {{1, 0}, {2, 0}, {3, 0}, {4, 0}};
  JointSpaceActiveSet solver;
  DualActiveSet careful;
  careful.reduce = false;
  Solution a, b;
  for (int seed = 0; seed < 100; ++seed) {
    p.z_u = Vector::Unit(6, 0);
    for (int k = 0; k < 4; ++k) p.c[k] = 1e-16 * ((seed * 7 + k * k * 31) % 11 - 2);
    a.reset(p.size(), p.rows());
    ASSERT_TRUE(solver.solve(p, {}, a)) << solver.reason() << ", seed " << seed;
    careful.solve(p, {}, b);
    ASSERT_EQ(b.status, Status::solved);
    EXPECT_EQ(a.z[0], 1);
    EXPECT_LE((a.z - b.z).norm(), 1e-19) << seed;
    EXPECT_LE((p.c - p.J * a.z).maxCoeff(), 1e-30) << seed;
  }
}

// Without contacts nothing dense is left: 4096 links, which would take 4 GB, take the storage of one more body each.
TEST(NullSpaceForm, AChainOfAnyLengthTakesNoDenseStorage) {
  const Instance chain = make_scenes("CHAIN(links=4096)").at(0);
  const Solution s = make_solver("dual_active_set").solve(chain.problem, {.memory_limit = 1e6});
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_EQ(s.z, chain.reference->z);
  EXPECT_EQ(s.margins.rank, 3 * 4096);
}

}  // namespace
}  // namespace zwang
