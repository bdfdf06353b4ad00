#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <zwang/core/referee/measure.h>
#include "tests/core/referee/friction/small_frictional.h"

namespace zwang {
namespace {

using test::block;
using test::judge;
using test::pinch;
using test::rod;
using test::vector;
using test::wedge;

Metrics judge_claim(const Problem& p, const Vector& certificate) {
  Solution s;
  s.status = Status::infeasible;
  s.certificate = certificate;
  return measure(p, s, nullptr, 1e-10);
}

TEST(FrictionJudge, KnowsASlidingAndAStickingBlock) {
  const Problem slides = block(4, 1, .5).problem();
  const Metrics right = judge(slides, vector({3.5, 0, 0}), vector({1, -.5, 0}));
  EXPECT_EQ(right.verdict, Verdict::solved);
  EXPECT_LE(right.z_bound, 1e-15);
  EXPECT_TRUE(right.friction.strict);
  EXPECT_TRUE(right.friction.isolated);
  EXPECT_EQ(right.friction.delta, 0);
  EXPECT_LE(right.friction.radius, 1e-20);
  EXPECT_LE(right.friction.self_bound, 1e-12);
  EXPECT_LE(right.friction.natural, 1e-16);
  EXPECT_LE(right.friction.eta, 1e-16);

  EXPECT_EQ(judge(slides, vector({3.5, 0, 0})).verdict, Verdict::solved) << "no multipliers are needed";
  EXPECT_EQ(judge(slides, vector({2.8, 0, 1.4}), vector({2.4, -1.2, 0})).verdict, Verdict::wrong)
      << "the convex law's answer";
  EXPECT_EQ(judge(slides, vector({3.5 + 1e-10, 0, 0}), vector({1, -.5, 0})).verdict, Verdict::near);
  EXPECT_EQ(judge(slides, vector({3.5, 0, -1e-3}), vector({1, -.5, 0})).verdict, Verdict::wrong);
  EXPECT_EQ(judge(block(.25, 1, .5).problem(), vector({0, 0, 0}), vector({1, -.25, 0})).verdict, Verdict::solved);
}

// A block on 250 copies of its contact, whose right sides disagree in their last digits: only so many digits show which
// of them carry it.
// What they disagree by vanishes in units of the motion.
TEST(FrictionJudge, RowsThatContradictEachOtherByNextToNothingHaveNoAnswer) {
  const auto verdict = [](double c) {
    test::SmallFrictional slides = block(4, 1, .5);
    slides.z_u *= 0x1p100;
    slides.equality(vector({0, 0, 1}), 0).equality(vector({0, 0, 1}), c);
    Vector lambda = Vector::Zero(5);
    lambda.head(2) << 0x1p100, -0x1p99;
    return judge(slides.problem(), 0x1p100 * vector({3.5, 0, 0}), lambda).verdict;
  };
  EXPECT_EQ(verdict(0), Verdict::solved);
  EXPECT_EQ(verdict(0x1p-1000), Verdict::wrong);
}

TEST(FrictionJudge, BoundsManyRedundantRowsThatDisagree) {
  const Problem one = block(4, 1, .5).problem();
  test::SmallFrictional many{.z_u = one.z_u};
  for (int k = 0; k < 250; ++k) {
    const double off = k % 7 * 1e-15;
    many.contact(.5, {{Vector(one.J.row(0).transpose()), one.c[0] - off},
                      {Vector(one.J.row(1).transpose()), off},
                      {Vector(one.J.row(2).transpose()), -off}});
  }
  for (const Law law : {Law::coulomb, Law::convex}) {
    const Problem p = many.problem(law);
    const Vector z = law == Law::coulomb ? vector({3.5, 0, 0}) : vector({2.8, 0, 1.4});
    const Metrics m = judge(p, z, {}, 1e-12);
    EXPECT_LE(law == Law::coulomb ? m.friction.self_bound : m.z_bound, 1e-11);
    EXPECT_NE(m.verdict, Verdict::wrong);
    EXPECT_NE(m.verdict, Verdict::undecided);
  }
}

TEST(FrictionJudge, MeasuresWhatIsOff) {
  const FrictionMetrics f = judge(block(4, 1, .5).problem(), vector({3.5, 0, -.1}), vector({1, .75, 0})).friction;
  const double s = std::sqrt(17);
  EXPECT_NEAR(f.penetration, .1 / s, 1e-15);
  EXPECT_NEAR(f.cone_violation, .25 / s, 1e-15);
  EXPECT_NEAR(f.complementarity, .1 / s / s, 1e-15);
  EXPECT_NEAR(f.dissipation, (.5 * 3.5 + .75 * 3.5) / s / s, 1e-15);
}

TEST(FrictionJudge, ConvexLawHasItsOwnAnswer) {
  const Problem p = block(4, 1, .5).problem(Law::convex);
  EXPECT_EQ(judge(p, vector({2.8, 0, 1.4}), vector({2.4, -1.2, 0})).verdict, Verdict::solved);
  EXPECT_EQ(judge(p, vector({2.8, 0, 1.4})).verdict, Verdict::solved);
  EXPECT_EQ(judge(p, vector({3.5, 0, 0}), vector({1, -.5, 0})).verdict, Verdict::wrong);
}

// A block that slides at v: iterates of the interior point come up to its flat cone from outside.
TEST(FrictionJudge, ConvexLawIsProvenWhereFrictionIsWeak) {
  for (const double mu : {.03, 1e-2, 1e-6, 1e-12}) {
    const Problem p = block(4, 10, mu).problem(Law::convex);
    const double slip = (4 - mu * 10) / (1 + mu * mu), load = 10 + mu * slip;
    const Metrics m = judge(p, vector({slip, 0, mu * slip}), vector({load, -mu * load, 0}));
    EXPECT_EQ(m.verdict, Verdict::solved) << mu;
    EXPECT_LE(m.z_bound, 1e-12) << mu;
    EXPECT_LE(m.complementarity, 1e-15) << mu;
    EXPECT_EQ(judge(p, vector({slip * (1 + 1e-6), 0, mu * slip})).verdict, Verdict::wrong) << mu;
  }
}

// So much friction that a slip of rounding lifts the cone as far as it takes: z keeps falling through the floor, and
// is Z of its own slip to all digits.
TEST(FrictionJudge, WhatPenetratesIsNotConsistent) {
  const Metrics m = judge(block(4, 10, 1e30).problem(), vector({4, 0, -10}), vector({0, 0, 0}));
  EXPECT_LE(m.friction.self_bound, 1e-12);
  EXPECT_EQ(m.verdict, Verdict::wrong);
}

TEST(FrictionJudge, JudgesWhatHasNoUnknowns) {
  for (const double c : {0., 1.}) {
    const Problem p = test::SmallFrictional{.z_u = Vector(0)}.contact(.5, {{Vector(0), c}, {Vector(0), 0.}}).problem();
    EXPECT_EQ(judge(p, Vector(0), vector({0, 0})).verdict, c > 0 ? Verdict::wrong : Verdict::solved);
  }
}

// A body at rest, beside a belt that cannot move it: no motion to measure errors by.
TEST(FrictionJudge, RestIsAnAnswerWhereNoRowAsksForMotion) {
  const Vector none = vector({0, 0}), left = vector({-1, 0}), up = vector({0, 1});
  for (const double room : {0., .5, -.5}) {
    const Problem p = test::SmallFrictional{.z_u = none, .mass = vector({2, 2})}
                          .equality(vector({1, -1}), 0)
                          .contact(.125, {{left, 0.}, {left, 0.}, {none, 0.}})
                          .contact(.125, {{none, 0.}, {none, 0.}, {none, -1.}})
                          .contact(.25, {{left, -room}, {up, 0.}, {left, 1.}})
                          .problem();
    const Verdict verdict = judge(p, none, Vector(Vector::Zero(p.rows()))).verdict;
    EXPECT_EQ(verdict, room < 0 ? Verdict::wrong : Verdict::solved) << room;
  }
}

TEST(FrictionJudge, AcceptsEachOfSeveralSolutions) {
  EXPECT_EQ(judge(rod(2), vector({2, .25, 0})).verdict, Verdict::solved) << "open";
  EXPECT_EQ(judge(rod(2), vector({17. / 12, 17. / 24, -17. / 24})).verdict, Verdict::solved) << "sticks";
  EXPECT_EQ(judge(rod(2), vector({1.75, .375, -.375})).verdict, Verdict::solved) << "slides";
  EXPECT_EQ(judge(rod(1), vector({17. / 12, 17. / 24, -17. / 24})).verdict, Verdict::wrong);
  EXPECT_EQ(judge(wedge(1, 0, 1), vector({0, 1})).verdict, Verdict::solved) << "pulled out";
  EXPECT_EQ(judge(wedge(1, 0, 1), vector({0, 0}), vector({.5, -.5, .5, -.5})).verdict, Verdict::solved) << "held";
  EXPECT_NE(judge(wedge(.5, 0, 1), vector({0, 0}), vector({.5, -.5, .5, -.5})).verdict, Verdict::solved);
}

TEST(FrictionJudge, AReferenceThatIsOneOfSeveralNeverMakesAnAnswerWrong) {
  Solution s;
  s.status = Status::solved;
  s.z = vector({2, .25, 0});
  Reference other{.z = vector({1.75, .375, -.375}), .unique = false, .method = "known answer"};
  const Metrics m = measure(rod(2), s, &other, 1e-10);
  EXPECT_EQ(m.verdict, Verdict::solved);
  EXPECT_GT(m.z_error, .1);
}

TEST(FrictionJudge, SaysNotIsolated) {
  const Metrics m = judge(pinch(), vector({0, 2}), vector({2, -2, 1, -1}) * .5);
  EXPECT_NE(m.verdict, Verdict::wrong);
  EXPECT_FALSE(m.friction.isolated);
}

TEST(FrictionJudge, JammedWedgeHasNoSolutionAndNothingIsSolved) {
  for (const double y : {0., 1e-9, .5, 1., -1.})
    EXPECT_NE(judge(wedge(1, -1, -1), vector({0, y})).verdict, Verdict::solved);
  EXPECT_EQ(judge(wedge(.5, -1, -1), vector({0, 0})).verdict, Verdict::solved) << "below mu = 3/4 it is no jam";
}

TEST(FrictionJudge, ACertificateWithATangentialPartProvesNothingForCoulomb) {
  // Two plates that push against each other: J_n z >= 1 on both sides of one coordinate.
  const auto shut = [](Law law) {
    return test::SmallFrictional{.z_u = vector({0, 0})}
        .contact(1, {{vector({1, 0}), 1}, {vector({0, 1}), 0}})
        .contact(1, {{vector({-1, 0}), 1}, {vector({0, 1}), 0}})
        .problem(law);
  };
  EXPECT_EQ(judge_claim(shut(Law::coulomb), vector({1, 0, 1, 0})).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(judge_claim(shut(Law::convex), vector({1, 0, 1, 0})).verdict, Verdict::infeasible_proven);
  // PINCH: the convex law has no answer, Coulomb's has a continuum.
  Problem p = pinch();
  EXPECT_NE(judge_claim(p, vector({1, 1, 1, -1})).verdict, Verdict::infeasible_proven);
  p.law = Law::convex;
  EXPECT_EQ(judge_claim(p, vector({1, 1, 1, -1})).verdict, Verdict::infeasible_proven);
  EXPECT_EQ(judge_claim(p, vector({1, 1.5, 1, -1.5})).verdict, Verdict::infeasible_proven) << "moved into the cone";
  // A null vector of rows with c = 0 gains nothing but rounding: z = 0 meets them.
  const auto cone = test::SmallFrictional{.z_u = vector({-2, -2}), .mass = vector({.5, .5})}
                        .contact(1, {{vector({-1, -2}), 0}, {vector({0, 3}), 0}})
                        .contact(1, {{vector({2, 0}), 0}, {vector({2, 2}), 0}})
                        .contact(1, {{vector({-2, 1}), 0}, {vector({2, 0}), 0}})
                        .contact(1, {{vector({1, -2}), 0}, {vector({-1, -3}), 0}})
                        .problem();
  EXPECT_NE(judge_claim(cone, vector({1, 0, 2, 0, 1, 0, 2, 2})).verdict, Verdict::infeasible_proven);
  // Where some z opens every contact there is a solution.
  EXPECT_EQ(judge_claim(block(4, 1, .5).problem(), vector({1, 0, 0})).verdict, Verdict::wrong);
  EXPECT_EQ(judge_claim(block(4, 1, .5).problem(Law::convex), vector({1, 0, 0})).verdict, Verdict::wrong);
}

TEST(FrictionJudge, DegenerateInput) {
  using test::SmallFrictional;
  // mu = 0 with tangent rows: K is a ray.
  EXPECT_EQ(judge(block(4, 1, 0).problem(), vector({4, 0, 0}), vector({1, 0, 0})).verdict, Verdict::solved);
  EXPECT_EQ(judge(block(4, 1, 0).problem(), vector({3.5, 0, 0}), vector({1, -.5, 0})).verdict, Verdict::wrong);
  // Nothing to do at all.
  EXPECT_EQ(judge(block(0, 0, .5).problem(), vector({0, 0, 0}), vector({0, 0, 0})).verdict, Verdict::solved);
  EXPECT_EQ(judge(block(4, 0, .5).problem(), vector({4, 0, 0}), vector({0, 0, 0})).verdict, Verdict::solved)
      << "grazes";
  // On the cone's edge: the friction that is needed is all there is.
  EXPECT_EQ(judge(block(.5, 1, .5).problem(), vector({0, 0, 0}), vector({1, -.5, 0})).verdict, Verdict::solved);
  // A contact that nothing can move: it holds, or there is no solution; the laws disagree.
  const Vector zero = vector({0, 0, 0});
  const auto fixed = [&](double c_n, double c_t, Law law) {
    SmallFrictional p = block(4, 1, .5);
    p.contact(1, {{zero, c_n}, {zero, c_t}, {zero, 0}});
    return p.problem(law);
  };
  const Vector slide = vector({3.5, 0, 0}), lambda = vector({1, -.5, 0, 0, 0, 0});
  EXPECT_EQ(judge(fixed(-1, 2, Law::coulomb), slide, lambda).verdict, Verdict::solved);
  EXPECT_EQ(judge(fixed(1, 0, Law::coulomb), slide, lambda).verdict, Verdict::wrong);
  EXPECT_EQ(judge(fixed(-1, 1, Law::convex), vector({2.8, 0, 1.4})).verdict, Verdict::solved) << "on the edge of K*";
  EXPECT_EQ(judge(fixed(-1, 2, Law::convex), vector({2.8, 0, 1.4})).verdict, Verdict::wrong);
  // Scales.
  for (const double scale : {0x1p-400, 0x1p400}) {
    Problem p = block(4, 1, .5).problem();
    p.z_u *= scale;
    EXPECT_EQ(judge(p, vector({3.5, 0, 0}) * scale, vector({1, -.5, 0}) * scale).verdict, Verdict::solved) << scale;
    EXPECT_EQ(judge(p, vector({3.4, 0, 0}) * scale, vector({1, -.5, 0}) * scale).verdict, Verdict::wrong) << scale;
    p = block(4, 1, .5).problem();
    p.J *= scale;
    EXPECT_EQ(judge(p, vector({3.5, 0, 0}), vector({1, -.5, 0}) / scale).verdict, Verdict::solved) << scale;
  }
  SmallFrictional heavy = block(4, 1, .5);
  heavy.mass = vector({1, 0x1p40, 1});
  EXPECT_EQ(judge(heavy.problem(), vector({3.5, 0, 0})).verdict, Verdict::solved);
  // The same contact four times, and an equality row twice.
  SmallFrictional often = block(4, 1, .5);
  for (int k = 0; k < 3; ++k)
    often.contact(.5, {{vector({0, 0, 1}), 0}, {vector({1, 0, 0}), 0}, {vector({0, 1, 0}), 0}});
  often.equality(vector({0, 1, 0}), 0).equality(vector({0, 2, 0}), 0);
  const Metrics m = judge(often.problem(), vector({3.5, 0, 0}));
  EXPECT_EQ(m.verdict, Verdict::solved);
  EXPECT_EQ(m.friction.delta, 0);
  EXPECT_EQ(judge(often.problem(), vector({3, 0, 0})).verdict, Verdict::wrong);
  often.equality(vector({0, 1, 0}), 1);
  EXPECT_EQ(judge(often.problem(), vector({3.5, 0, 0})).verdict, Verdict::wrong) << "rows that contradict each other";
}

TEST(FrictionJudge, NeverThrowsOnABadSolution) {
  const Problem p = block(4, 1, .5).problem();
  EXPECT_EQ(judge(p, vector({3.5, 0})).verdict, Verdict::wrong);
  EXPECT_EQ(judge(p, vector({std::numeric_limits<double>::quiet_NaN(), 0, 0})).verdict, Verdict::wrong);
  EXPECT_EQ(judge(p, vector({1e308, 1e308, 1e308})).verdict, Verdict::wrong);
  EXPECT_EQ(judge(p, vector({3.5, 0, 0}), vector({1e300, -1e300, 1e300})).verdict, Verdict::solved);
}

}  // namespace
}  // namespace zwang
