#include <zwang/core/referee/island_split.h>

#include <gtest/gtest.h>

#include <cmath>

#include <zwang/core/referee/measure.h>
#include "tests/core/referee/friction/small_frictional.h"

namespace zwang {
namespace {

using test::block;
using test::judge;
using test::vector;

// Two blocks that slide and stick, and an unknown that nothing meets; their unknowns are shuffled.
struct TwoBlocks {
  const std::vector<Index> slides = {6, 0, 3}, sticks = {1, 5, 2};
  test::SmallFrictional all{.z_u = Vector::Zero(7)};
  Vector z = Vector::Zero(7), lambda;

  TwoBlocks() {
    add(block(4, 1, .5).problem(), slides);
    add(block(.25, 1, .5).problem(), sticks);
    all.z_u[4] = z[4] = 2;
    z[6] = 3.5;
    lambda = vector({1, -.5, 0, 1, -.25, 0});
  }

 private:
  void add(const Problem& one, const std::vector<Index>& at) {
    all.z_u(at) = one.z_u;
    const auto row = [&](Index i) {
      Vector entries = Vector::Zero(7);
      entries(at) = Matrix(one.J).row(i).transpose();
      return std::pair(entries, one.c[i]);
    };
    all.contact(one.mu[0], {row(0), row(1), row(2)});
  }
};

TEST(IslandSplit, ContactsStayWholeAndTheRestIsOnePart) {
  const TwoBlocks two;
  const std::vector<IslandPart> islands = split_islands(two.all.problem());
  ASSERT_EQ(islands.size(), 3u);
  EXPECT_EQ(islands[0].columns, (std::vector<Index>{0, 3, 6}));
  EXPECT_EQ(islands[0].rows, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(islands[1].columns, (std::vector<Index>{1, 2, 5}));
  EXPECT_EQ(islands[2].columns, (std::vector<Index>{4}));
  EXPECT_TRUE(islands[2].rows.empty());
  EXPECT_EQ(islands[0].problem.mu, vector({.5, 0, 0}));
  EXPECT_EQ(islands[0].problem.J.coeff(0, 2), two.all.problem().J.coeff(0, 6));
  EXPECT_TRUE(split_islands(block(4, 1, .5).problem()).empty());
}

TEST(IslandSplit, RowsThatMeetNothingAreNotLost) {
  TwoBlocks two;
  two.all.contact(.5, {{Vector::Zero(7), -1.0}, {Vector::Zero(7), 0.0}});
  const std::vector<IslandPart> islands = split_islands(two.all.problem());
  ASSERT_EQ(islands.size(), 3u);
  EXPECT_EQ(islands[0].rows, (std::vector<Index>{0, 1, 2, 6, 7}));
}

TEST(IslandSplit, VerdictsAreThoseOfTheWhole) {
  const TwoBlocks two;
  const Problem p = two.all.problem();
  for (const Vector& lambda : {two.lambda, Vector()}) {
    const Metrics right = judge(p, two.z, lambda);
    EXPECT_EQ(right.verdict, Verdict::solved);
    EXPECT_LE(right.z_bound, 1e-15);
    EXPECT_LE(right.friction.self_bound, 1e-12);
    EXPECT_EQ(right.friction.delta, 0);
    EXPECT_TRUE(right.friction.strict);
    EXPECT_TRUE(right.friction.isolated);
  }
  const double s = two.all.z_u.norm();
  for (Index j = 0; j < p.size(); ++j)
    for (const auto& [off, verdict] : {std::pair(1e-10, Verdict::near), {1e-3, Verdict::wrong}}) {
      Vector z = two.z;
      z[j] += off;
      const Metrics m = judge(p, z, two.lambda);
      EXPECT_EQ(m.verdict, verdict) << j << " off by " << off;
      EXPECT_TRUE(verdict == Verdict::wrong || std::abs(m.z_bound - off / s) <= 1e-3 * off) << m.z_bound;
    }
}

// s is that of the whole: a part that hardly moves may be off by more than its own motion.
TEST(IslandSplit, ErrorsAreRelativeToTheWholeMotion) {
  TwoBlocks two;
  two.all.z_u[4] = two.z[4] = 1e9;
  Vector z = two.z;
  z[5] += 1e-6;
  EXPECT_EQ(judge(two.all.problem(), z, two.lambda).verdict, Verdict::solved);
}

TEST(IslandSplit, TheConvexLawIsBoundedPartByPart) {
  const TwoBlocks two;
  const Problem p = two.all.problem(Law::convex);
  Vector z = two.z;
  z(two.slides) = vector({2.8, 0, 1.4});  // its answer where the block slides
  const Metrics right = judge(p, z);
  EXPECT_EQ(right.verdict, Verdict::solved);
  EXPECT_LE(right.z_bound, 1e-13);
  EXPECT_EQ(judge(p, two.z).verdict, Verdict::wrong) << "Coulomb's answer";
}

}  // namespace
}  // namespace zwang
