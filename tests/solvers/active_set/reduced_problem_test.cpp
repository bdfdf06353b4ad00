// nnls and cholesky in reduced form against themselves as given.
#include <zwang/solvers/active_set/null_space_adapter.h>

#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/random_mechanism.h"

namespace zwang {
namespace {

using test::distance, test::Graph, test::graphs, test::random_mechanism, test::seeds;

class ReducedMethod : public testing::TestWithParam<const char*> {
 protected:
  AnySolver plain = make_solver(GetParam()), reduced = make_solver(GetParam() + std::string(":reduce=on"));
};

TEST_P(ReducedMethod, GivesTheMotionOfThePlainPathOnRandomMechanisms) {
  for (const Graph graph : graphs) {
    int compared = 0, in_reduced_form = 0;
    for (unsigned seed = 0; seed < seeds(graph, 100); ++seed) {
      const Problem p = random_mechanism(graph, seed);
      const Solution a = reduced.solve(p), b = plain.solve(p);
      ASSERT_EQ(a.status, b.status) << p.name << ": " << a.message;
      in_reduced_form += a.message.empty();
      // Where joints alone determine a row, rounding in c contradicts them (100 digits agree): that is flagged.
      if (b.status != Status::solved && b.status != Status::solved_ill_conditioned) continue;
      if (b.margins.smallest_accepted < 1e-6) continue;
      ++compared;
      EXPECT_LE(distance(p, a.z, b.z), 1e-12) << p.name << ": " << a.message;
      const Metrics own = measure(p, a, nullptr, 1e-10), other = measure(p, b, nullptr, 1e-10);
      EXPECT_LE(own.stationarity, 1e-13 + 10 * other.stationarity) << p.name;
      EXPECT_LE(own.primal, 1e-13 + 10 * other.primal) << p.name;
    }
    EXPECT_GE(compared, static_cast<int>(seeds(graph, 90))) << static_cast<int>(graph);
    EXPECT_GE(in_reduced_form, graph == Graph::redundant_joints ? 0 : static_cast<int>(seeds(graph, 80)))
        << static_cast<int>(graph);
  }
}

TEST_P(ReducedMethod, SolvesHandsInReducedFormAndAllocatesNothingTheSecondTime) {
  for (const Instance& hand : make_scenes("hand(contacts=4,16,64,seed=1..3)")) {
    const Problem& p = hand.problem;
    const Solution b = plain.solve(p);
    Solution a;
    reduced.solve(p, {}, a);
    const long before = allocations();
    reduced.solve(p, {}, a);
    EXPECT_EQ(allocations() - before, 0) << p.name;
    ASSERT_EQ(a.status, b.status) << p.name;
    if (b.status != Status::solved) continue;
    EXPECT_EQ(a.message, "") << p.name;
    EXPECT_LE(distance(p, a.z, b.z), 1e-12) << p.name;
    EXPECT_EQ(measure(p, a, nullptr, 1e-10).verdict, Verdict::solved) << p.name;
  }
}

// Islands apart, warm starts by key.
TEST_P(ReducedMethod, SolvesSeveralHandsColdAndWarm) {
  const Problem p = make_scenes("hands(hands=3,contacts=16)").front().problem;
  const Solution b = plain.solve(p), cold = reduced.solve(p);
  ASSERT_EQ(cold.status, Status::solved) << cold.message;
  EXPECT_EQ(cold.message, "");
  EXPECT_LE(distance(p, cold.z, b.z), 1e-12);
  const WarmStart start{p.key, cold.lambda};
  const Solution warm = reduced.solve(p, {.warm_start = &start});
  EXPECT_LT(warm.iterations, cold.iterations);
  EXPECT_LE(distance(p, warm.z, cold.z), 1e-15);
}

TEST_P(ReducedMethod, SaysWhyItDidNotReduceAndProvesInfeasibility) {
  Problem p = random_mechanism(Graph::floating_tree, 5);
  int calls = 0;
  const Solution watched = reduced.solve(p, {.observe = [&](int, const Vector&, const Vector&) { ++calls; }});
  EXPECT_EQ(watched.message, "not reduced: an observer");
  EXPECT_TRUE(watched.fallback);

  // The last row once more, turned around and out of reach.
  const Index m = p.rows();
  ASSERT_FALSE(p.is_equality(m - 1));
  Matrix J(m + 1, p.size());
  J << Matrix(p.J), -Matrix(p.J).row(m - 1);
  p.J = J.sparseView();
  p.c.conservativeResize(m + 1);
  p.c[m] = 1 - p.c[m - 1];
  p.kind.push_back(RowKind::inequality);
  p.key.push_back({static_cast<std::uint64_t>(m), 0});
  const Solution s = reduced.solve(p);
  EXPECT_EQ(s.status, Status::infeasible);
  EXPECT_EQ(measure(p, s, nullptr, 1e-10).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(s.message, "not reduced: the reduced problem is not solved");
}

INSTANTIATE_TEST_SUITE_P(Solvers, ReducedMethod, testing::Values("nnls", "cholesky"),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
}  // namespace zwang
