// dual_active_set on a thousand random hands: its fast path against its careful one and against another method.
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <limits>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/active_set/nnls.h>
#include "tests/solvers/random_mechanism.h"

namespace zwang {
namespace {

constexpr int hands_tried = 1000;

// Any pose, joints open by a micrometre to a centimetre, up to 100 contacts and 20 limits, the index finger locked or
// not. Where the gaps are not drawn around a motion, some ask for what no motion gives.
Problem random_hand(int seed) {
  Draw draw(seed);
  const double contacts = draw.below(4) ? draw.below(101) : draw.below(9);
  const double limits = draw.below(3) ? draw.below(9) : draw.below(21);
  const double drift = std::exp2(-draw.uniform(7, 20));
  return hands({{"hands", 1},
                {"contacts", contacts},
                {"limits", limits},
                {"drift", drift},
                {"feasible", draw.below(2)},
                {"locked", draw.below(8) == 0},
                {"seed", seed}})
      .problem;
}

TEST(RandomHands, AreSolvedAlikeByTheFastPathTheCarefulOneAndNnls) {
  DualActiveSet fast, careful;
  careful.reduce = false;
  Nnls other;
  JointSpaceActiveSet reduced;
  Solution a, b, c, d;
  int infeasible = 0, taken = 0, compared = 0, nnls_alike = 0;
  for (int seed = 1; seed <= hands_tried; ++seed) {
    const Problem p = random_hand(seed);
    fast.solve(p, {}, a);
    careful.solve(p, {}, b);
    other.solve(p, {}, c);
    d.reset(p.size(), p.rows());
    const bool by_fast_path = reduced.solve(p, {}, d);
    taken += by_fast_path;
    ASSERT_EQ(a.status, b.status) << seed << ": " << to_string(a.status) << ", " << to_string(b.status);
    if (a.status == Status::infeasible) {
      ++infeasible;
      EXPECT_FALSE(by_fast_path) << seed;
      EXPECT_EQ(measure(p, a, nullptr, 1e-10).verdict, Verdict::infeasible_proven) << seed;
      EXPECT_NE(c.status, Status::solved) << seed;
      continue;
    }
    ASSERT_TRUE(a.status == Status::solved || a.status == Status::solved_ill_conditioned)
        << seed << ": " << to_string(a.status);
    if (a.status != Status::solved) continue;
    ++compared;
    EXPECT_LE(test::distance(p, a.z, b.z), 1e-12) << seed;
    if (c.status != Status::solved) continue;
    ++nnls_alike;
    EXPECT_LE(test::distance(p, a.z, c.z), 1e-12) << seed;
  }
  RecordProperty("infeasible", infeasible);
  RecordProperty("fast path", taken);
  EXPECT_GE(infeasible, 19);
  EXPECT_GE(compared, hands_tried - infeasible - 20);
  EXPECT_GE(nnls_alike, compared - 20);
  EXPECT_GE(taken, (hands_tried - infeasible) * 9 / 10);
}

// More rows violated without contact forces than enter the climb at once: a motion that meets all rows, most of them
// nearly touched, and a hand thrown off it against a quarter of them.
TEST(RandomHands, OfHundredsOfViolatedRowsThoseThatEnterLateAreObeyed) {
  DualActiveSet careful;
  careful.reduce = false;
  JointSpaceActiveSet reduced;
  Solution free, fast, right;
  int taken = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    Problem p = hands({{"hands", 1},
                       {"contacts", 300},
                       {"limits", 5},
                       {"drift", 0x1p-13},
                       {"feasible", 1},
                       {"locked", 0},
                       {"seed", seed}})
                    .problem;
    careful.solve(p, {}, right);
    ASSERT_EQ(right.status, Status::solved) << seed;
    Draw draw(seed);
    Vector force = Vector::Zero(p.rows());
    Problem joints = p;
    for (Index i = 0; i < p.rows(); ++i) {
      if (p.is_equality(i)) continue;
      p.c[i] = p.J.row(i).dot(right.z) - 1e-3 * draw.uniform(0, 1);
      force[i] = draw.below(4) ? 0 : draw.uniform(1, 10);
      joints.c[i] = -std::numeric_limits<double>::infinity();
    }
    p.z_u = joints.z_u = right.z - Matrix(p.M).llt().solve(p.J.transpose() * force);
    careful.solve(joints, {}, free);
    const Vector slack = p.J * free.z - p.c;
    EXPECT_GT((slack.array() < 0).count(), 100) << seed;

    careful.solve(p, {}, right);
    ASSERT_EQ(right.status, Status::solved) << seed;
    fast.reset(p.size(), p.rows());
    if (!reduced.solve(p, {}, fast)) continue;
    ++taken;
    EXPECT_LE(test::distance(p, fast.z, right.z), 1e-12) << seed;
  }
  EXPECT_GE(taken, 8);
}

}  // namespace
}  // namespace zwang
