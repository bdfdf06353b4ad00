#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <zwang/core/referee/measure.h>
#include "tests/core/referee/friction/attacks.h"

// Answers whose truth is known without the referee, each of which it once judged falsely.

namespace zwang {
namespace {

using test::judge;
using test::SmallFrictional;
using test::vector;

bool called_right(Verdict v) { return v == Verdict::solved || v == Verdict::near || v == Verdict::consistent; }

TEST(PlantedTruth, NoAttackSucceeds) {
  int right = 0, open = 0;
  for (const test::Attack& a : test::attacks())
    for (const double tolerance : {1e-13, 1e-8, 1e-2}) {
      const Metrics m = judge(a.problem, a.z, a.lambda, tolerance);
      EXPECT_EQ(a.falsehood(m.verdict, tolerance, 0, m.friction.delta > 0 ? Metrics::unknown : m.z_bound), "")
          << a.name << ", off by " << a.off() << ", T = " << tolerance << ", z = " << a.z.transpose().head(2);
      right += a.off() == 0;
      open += a.off() == 0 && m.verdict != Verdict::solved;
    }
  EXPECT_GT(right, 200);
  EXPECT_LT(open, right / 5);
}

// A floor that carries a block of weight 0.3, and a second contact that says nothing, c = -Inf. z* = 0: any push of the
// second one lifts the block.
TEST(PlantedTruth, AContactThatSaysNothingCannotPush) {
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  const Vector up = vector({0, 1}), along = vector({1, 0});
  for (const Law law : {Law::coulomb, Law::convex})
    for (const double mu : {.5, 1e4}) {
      const Problem p = SmallFrictional{.z_u = vector({0, -.3})}
                            .contact(mu, {{up, 0}, {along, 0}})
                            .contact(mu, {{up, nothing}, {along, 0}})
                            .problem(law);
      const double push = 100;
      EXPECT_FALSE(called_right(judge(p, vector({0, push - .3}), vector({0, 0, push, 0}), 1e-8).verdict)) << mu;
      EXPECT_FALSE(called_right(judge(p, vector({7, push - .3}), vector({0, 0, push, 7}), 1e-8).verdict)) << mu;
      EXPECT_EQ(judge(p, vector({0, 0}), vector({.3, 0, 0, 0}), 1e-8).verdict, Verdict::solved) << mu;
      EXPECT_GT(judge(p, vector({0, push - .3}), vector({0, 0, push, 0}), 1e-8).stationarity, .5) << mu;
    }
  // Without friction no verdict came of it, but a number that said nothing was wrong.
  Problem p = SmallFrictional{.z_u = vector({0, -.3})}
                  .contact(0, {{up, 0}})
                  .contact(0, {{up, nothing}})
                  .problem(Law::frictionless);
  p.mu.resize(0);
  EXPECT_GT(judge(p, vector({0, 99.7}), vector({0, 100}), 1e-8).stationarity, .5);
}

// x >= 1 and x <= 1 - overlap beside friction: there is no z. The rows show it, whatever solves rows nearby.
TEST(PlantedTruth, WallsThatOverlapLeaveNoSolution) {
  for (const double overlap : {1., 0x1p-10, 0x1p-24, 0x1p-40, 0x1p-52}) {
    const Problem p = SmallFrictional{.z_u = vector({0, 0})}
                          .contact(1, {{vector({1, 0}), 1}, {vector({0, 1}), 0}})
                          .contact(1, {{vector({-1, 0}), overlap - 1}, {vector({0, 1}), 0}})
                          .problem();
    for (const Vector& z : {vector({1, 0}), vector({1 - overlap, 0}), vector({1 - overlap / 2, 0})})
      for (const Vector& lambda : {Vector(), vector({1, 0, 0, 0}), vector({2, 0, 1, 0})})
        for (const double tolerance : {1e-2, 1e-8})
          EXPECT_EQ(judge(p, z, lambda, tolerance).verdict, Verdict::wrong) << overlap;
  }
}

// Beside a block that slides, x = 0 and x + e y = e / 8: y = 1/8, whatever e > 0. The rows turn apart by e.
TEST(PlantedTruth, RowsThatAreNearlyParallelAreTwoRows) {
  for (const int k : {20, 23, 27, 30, 34, 40, 45, 60}) {
    const double e = std::ldexp(1.0, -k);
    const Problem p = SmallFrictional{.z_u = vector({4, 0, -1, 0, 0})}
                          .contact(.5, {{vector({0, 0, 1, 0, 0}), 0}, {vector({1, 0, 0, 0, 0}), 0}})
                          .equality(vector({0, 0, 0, 1, 0}), 0)
                          .equality(vector({0, 0, 0, 1, e}), e / 8)
                          .problem();
    const Vector right = vector({3.5, 0, 0, 0, .125}), wrong = vector({3.5, 0, 0, 0, 0});
    const Vector lambda = vector({1, -.5, -.125 / e, .125 / e});
    for (const double tolerance : {1e-8, 1e-6}) {
      EXPECT_FALSE(called_right(judge(p, wrong, {}, tolerance).verdict)) << k;
      EXPECT_FALSE(called_right(judge(p, wrong, vector({1, -.5, 0, 0}), tolerance).verdict)) << k;
      EXPECT_NE(judge(p, right, {}, tolerance).verdict, Verdict::wrong) << k;
      if (k <= 34) {
        EXPECT_EQ(judge(p, right, lambda, tolerance).verdict, Verdict::solved) << k;
      }
    }
  }
}

// The same friction in other units: rows along the ground times e, mu over e.
TEST(PlantedTruth, TheUnitOfTheGroundSaysNothing) {
  for (const int k : {0, 10, 23, 30, 40}) {
    const double e = std::ldexp(1.0, -k);
    const Problem p = SmallFrictional{.z_u = vector({4, 0, -1})}
                          .contact(.5 / e, {{vector({0, 0, 1}), 0}, {vector({e, 0, 0}), 0}, {vector({0, e, 0}), 0}})
                          .problem();
    EXPECT_EQ(judge(p, vector({3.5, 0, 0}), vector({1, -.5 / e, 0}), 1e-8).verdict, Verdict::solved) << k;
    for (const double off : {.4, -.4, .5, 1e-3}) {
      EXPECT_FALSE(called_right(judge(p, vector({3.5 + off, 0, 0}), {}, 1e-8).verdict)) << k;
      EXPECT_FALSE(called_right(judge(p, vector({3.5 + off, 0, 0}), vector({1, (off - .5) / e, 0}), 1e-8).verdict))
          << k;
    }
  }
}

// 0 >= 1e-300 and 0 = 1e300 never hold, whatever the motions beside them.
TEST(PlantedTruth, RowsOfZerosAreDecidedAsStored) {
  const Vector none = vector({0, 0}), up = vector({0, 1}), along = vector({1, 0});
  for (const double size : {1e300, 1., 1e-20})
    for (const double c : {1e-300, 1., 1e300}) {
      const auto beside = [&](double own) {
        return SmallFrictional{.z_u = vector({size, size})}
            .contact(.5, {{up, 0}, {along, 0}})
            .contact(.5, {{none, own}, {none, 0}})
            .problem();
      };
      const Vector z = vector({size, size}), still = Vector::Zero(4);
      EXPECT_EQ(judge(beside(c), z, still, 1e-8).verdict, Verdict::wrong) << size << ' ' << c;
      EXPECT_EQ(judge(beside(-c), z, still, 1e-8).verdict, Verdict::solved) << size << ' ' << c;
      for (const bool joint : {false, true}) {
        SmallFrictional rows{.z_u = vector({size, size})};
        Problem p = (joint ? rows.equality(none, c) : rows.contact(0, {{none, c}})).problem();
        p.mu.resize(0);
        EXPECT_EQ(judge(p, z, Vector::Zero(1), 1e-8).verdict, Verdict::wrong) << size << ' ' << c;
      }
    }
}

// M = U'U, U = (p, p + 1; p - 1, p) of determinant 1, which factors of 64 bits cannot tell from singular. z* = M^-1 J'
// is of integers; nothing is proven, and nothing may be said.
TEST(PlantedTruth, NothingIsSaidWhereTheMassIsBeyondTheFactors) {
  constexpr double p = 4e7, a = p * p + (p - 1) * (p - 1), b = p * (p + 1) + (p - 1) * p, d = (p + 1) * (p + 1) + p * p;
  Problem mass{.name = "unimodular", .z_u = vector({0, 0})};
  Matrix M(2, 2), J(1, 2);
  M << a, b, b, d;
  J << 1, 0;
  mass.M = M.sparseView();
  mass.J = J.sparseView();
  mass.c = vector({d});
  mass.kind = {RowKind::inequality};
  mass.key.resize(1);
  EXPECT_NE(judge(mass, vector({d, -b}), vector({1}), 1e-8).verdict, Verdict::wrong);
  EXPECT_FALSE(called_right(judge(mass, vector({d, -b + 1}), vector({1}), 1e-8).verdict));
}

// The plates may move apart along themselves in many ways; how little friction there is says nothing about that.
TEST(PlantedTruth, AContinuumIsNotIsolated) {
  for (const double mu : {1., 1e-4, 1e-8, 1e-12}) {
    Problem p = test::pinch();
    p.mu *= mu;
    for (const double load : {0., .25, .5}) {
      const Vector z = vector({0, 3 - 2 * mu * load}), lambda = vector({load, -mu * load, load, -mu * load});
      EXPECT_FALSE(judge(p, z, lambda, 1e-8).friction.isolated) << mu << ' ' << load;
    }
  }
}

}  // namespace
}  // namespace zwang
