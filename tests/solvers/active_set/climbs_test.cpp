// The inner machines of dual_active_set and nnls, before anything is polished: their points are those of least
// distance, from any start.
#include <gtest/gtest.h>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/active_set/careful_climb.h>
#include <zwang/solvers/active_set/least_distance.h>

#include "tests/parameter_name.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

constexpr double close = 1e-9;

class Climbs : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    problem_ = make_scenes(GetParam()).at(0).problem;
    ASSERT_TRUE(w_.build(problem_));
  }
  // y = G'u, u_I >= 0, G y = h or >= h, and no row pushes that is not met.
  void expect_optimum(const Vector& y, const Vector& unit) const {
    Vector left = y;
    int pushing = 0;
    for (Index i = 0; i < w_.rows(); ++i) {
      const double slack = w_.dot(i, y) - w_.h[i];
      w_.add(i, -unit[i], left);
      EXPECT_GE(slack, -close) << i;
      EXPECT_TRUE(w_.equality[at(i)] || unit[i] >= 0) << i;
      if (w_.equality[at(i)] || unit[i] > 0) {
        EXPECT_LE(slack, close) << i;
      }
      pushing += !w_.equality[at(i)] && unit[i] > 0;
    }
    EXPECT_LE(left.norm(), close * (1 + y.norm()));
    EXPECT_GT(pushing, 0);
  }
  std::vector<Index> inequalities() const {
    std::vector<Index> rows;
    for (Index i = 0; i < w_.rows(); ++i)
      if (!w_.equality[at(i)]) rows.push_back(i);
    return rows;
  }

  Problem problem_;
  Whitened w_;
  const Deadline deadline_;
};

TEST_P(Climbs, TheCarefulOneEndsAtTheOptimumFromAnyStart) {
  for (const bool sparse : {false, true})
    for (const bool warm : {false, true}) {
      CarefulClimb climb;
      climb.reset(w_, sparse, deadline_);
      climb.warm_start(warm ? inequalities() : std::vector<Index>());
      int iterations = 0;
      ASSERT_EQ(dual_climb(climb, iterations, 1000, deadline_, [] {}), Status::solved);
      climb.locate();
      expect_optimum(climb.y(), climb.unit());
    }
}

TEST_P(Climbs, LeastDistanceEndsAtTheOptimumFromAnyStart) {
  for (const bool warm : {false, true}) {
    LeastDistance nearest;
    nearest.reset(w_, deadline_);
    int iterations = 0;
    ASSERT_EQ(nearest.solve(warm ? inequalities() : std::vector<Index>(), iterations, 1000, {}), Status::solved);
    Vector y, unit;
    nearest.locate(y, unit);
    expect_optimum(y, unit);
    for (const Index i : nearest.pushing()) EXPECT_GT(unit[i], 0) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(ActiveSet, Climbs,
                         testing::Values("random(n=40,m=50,equalities=.3,seed=3)", "hand(contacts=8,seed=2)",
                                         "tower(boxes=8)"),
                         [](const auto& i) { return test::parameter_name(i.param); });

// A row that asks for more than others allow: what either machine names is a Farkas vector.
TEST(ClimbsOfContradictions, EndWithTheProof) {
  const Problem p =
      test::make_problem(test::vec({2, 1, 4}), test::vec({0, 0, 0}),
                         {{RowKind::equality, test::vec({1, 1, 0}), 1},
                          {RowKind::inequality, test::vec({1, 0, 1}), 2},
                          {RowKind::inequality, test::vec({0, 1, -1}), 3}});  // the last two ask for z_0 + z_1 >= 5
  Whitened w;
  ASSERT_TRUE(w.build(p));
  const Deadline deadline;
  const auto expect_proof = [&](const Vector& unit) {
    Vector motion = Vector::Zero(w.size());
    for (Index i = 0; i < w.rows(); ++i) w.add(i, unit[i], motion);
    EXPECT_LE(motion.norm(), 1e-14 * unit.norm());
    EXPECT_GT(w.h.dot(unit), 0.1 * unit.norm());
    for (Index i = 0; i < w.rows(); ++i) EXPECT_TRUE(w.equality[at(i)] || unit[i] >= 0);
  };
  CarefulClimb climb;
  climb.reset(w, false, deadline);
  int iterations = 0;
  ASSERT_EQ(dual_climb(climb, iterations, 100, deadline, [] {}), Status::infeasible);
  expect_proof(climb.unit());
  LeastDistance nearest;
  nearest.reset(w, deadline);
  iterations = 0;
  ASSERT_EQ(nearest.solve({}, iterations, 100, {}), Status::infeasible);
  Vector y, unit;
  nearest.locate(y, unit);
  expect_proof(unit);
  EXPECT_TRUE(y.isZero(0));
  EXPECT_EQ(nearest.pushing().size(), 2u);
}

}  // namespace
}  // namespace zwang
