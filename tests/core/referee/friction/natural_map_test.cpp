#include <zwang/core/referee/friction/natural_map.h>

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/referee/friction/small_frictional.h"

// Planted truths in rationals, for the proof by slopes alone.

namespace zwang {
namespace {

using test::block;
using test::pinch;
using test::rod;
using test::SmallFrictional;
using test::vector;
using test::wedge;

// A problem with an answer, in the proof's units.
struct Near {
  ScaledProblem scaled;
  ContactProblem p;
  explicit Near(const Problem& problem) : scaled(problem), p(problem, scaled, scaled.norm_of_free_motion()) {}

  ExtendedVector at(const Vector& z) const { return p.motion(z); }
  ModeProof prove(const Vector& z, const Vector& lambda) const {
    return prove_by_slopes(p, at(z), p.multipliers(lambda));
  }
  // |z - the solution that was proven|_M, over s; infinity where none was.
  double off(const Vector& z, const Vector& lambda) const {
    const ModeProof proof = prove(z, lambda);
    if (!proof.proven) return std::numeric_limits<double>::infinity();
    return (p.norm(at(z) - proof.point.x) + proof.radius) / p.scale;
  }
  bool none(const Vector& z, double distance) const { return none_by_slopes(p, at(z), distance * p.scale); }
};

TEST(NaturalMap, ProvesStrictSolutions) {
  const Near slides(block(4, 1, .5).problem());
  EXPECT_LE(slides.off(vector({3.5, 0, 0}), vector({1, -.5, 0})), 1e-25);
  EXPECT_LE(slides.off(vector({3.5, 1e-9, 1e-9}), vector({1, -.5, 1e-9})), 1e-8) << "from nearby";
  const Near sticks(block(.25, 1, .5).problem());
  EXPECT_LE(sticks.off(vector({0, 0, 0}), vector({1, -.25, 0})), 1e-25);
  const Near free(block(4, -1, .5).problem());
  EXPECT_LE(free.off(vector({4, 0, 1}), vector({0, 0, 0})), 1e-25);
  EXPECT_GT(slides.off(vector({3, 0, 0}), vector({1, -.5, 0})), .1) << "it finds the other";
}

// The force exactly on the edge of its cone without slip, in a plane and in space; a contact that touches without
// force; both at once; a force of zero at a contact that slips.
TEST(NaturalMap, ProvesSolutionsWhoseModesAreNotStrict) {
  const Near edge(block(.5, 1, .5).problem());
  EXPECT_LE(edge.off(vector({0, 0, 0}), vector({1, -.5, 0})), 1e-25);
  EXPECT_LE(Near(block(.25, 0, .5).problem()).off(vector({.25, 0, 0}), vector({0, 0, 0})), 1e-25) << "no force, no gap";
  SmallFrictional slanted = block(.375, 1, .625);
  slanted.z_u[1] = .5;  // |(3/8, 4/8)| = 5/8
  EXPECT_LE(Near(slanted.problem()).off(vector({0, 0, 0}), vector({1, -.375, -.5})), 1e-25);
  const Problem plane = SmallFrictional{.z_u = vector({.5, -1, 3})}
                            .contact(.5, {{vector({0, 1, 0}), 0}, {vector({1, 0, 0}), 0}})
                            .contact(0, {{vector({0, 0, 1}), 3}})
                            .problem();
  EXPECT_LE(Near(plane).off(vector({0, 0, 3}), vector({1, -.5, 0})), 1e-25);
}

// A contact without friction that is open, beside one that slides: its residual was its gap once.
TEST(NaturalMap, ProjectsOntoARay) {
  SmallFrictional two = block(4, 1, .5);
  two.contact(0, {{vector({0, 1, 0}), -3}});
  const Problem p = two.problem();
  EXPECT_LE(Near(p).off(vector({3.5, 0, 0}), vector({1, -.5, 0, 0})), 1e-25);
  EXPECT_LE(test::judge(p, vector({3.5, 0, 0}), vector({1, -.5, 0, 0})).friction.natural, 1e-16);
}

// Two solutions apart: each is proven, and nothing between them.
TEST(NaturalMap, TellsSolutionsApart) {
  const Near three(rod(2));
  EXPECT_LE(three.off(vector({2, .25, 0}), vector({0, 0})), 1e-25) << "it lifts";
  EXPECT_LE(three.off(vector({1.75, .375, -.375}), vector({.125, -.25})), 1e-25) << "it slides";
  EXPECT_LE(three.off(vector({17. / 12, 17. / 24, -17. / 24}), vector({11. / 24, -7. / 12})), 1e-15) << "it sticks";
  EXPECT_TRUE(three.none(vector({1.875, .3125, -.1875}), .01)) << "half way";
  EXPECT_FALSE(three.none(vector({2, .25, 0}), .1));
  EXPECT_FALSE(three.none(vector({1.9, .25, 0}), .2));
}

TEST(NaturalMap, ProvesThatThereIsNone) {
  const Near slides(block(4, 1, .5).problem());
  for (const double off : {1., 1e-2, 1e-4, 1e-6}) {
    EXPECT_TRUE(slides.none(vector({3.5 + off, 0, 0}), off / 16)) << off;
    EXPECT_TRUE(slides.none(vector({3.5, 0, off}), off / 16)) << off;
    EXPECT_TRUE(slides.none(vector({3.5, off, 0}), off / 16)) << off;
    EXPECT_FALSE(slides.none(vector({3.5 + off, 0, 0}), off)) << off;
  }
  const Near edge(block(.5, 1, .5).problem());
  EXPECT_TRUE(edge.none(vector({1e-3, 0, 0}), 1e-4));
  EXPECT_FALSE(edge.none(vector({1e-5, 0, 0}), 1e-4));
  // A wedge that is dragged into its walls beyond mu = 3/4 has no solution anywhere.
  // (Where both walls touch, their forces are not bounded by balance alone.)
  const Near jam(wedge(1, -1, -1));
  for (const Vector& z : {vector({0, 1}), vector({.75, 1}), vector({-.75, 1})}) EXPECT_TRUE(jam.none(z, 1e-3));
}

// Of a continuum no solution is the only one in a box, and none is denied.
TEST(NaturalMap, SaysNothingOfAContinuum) {
  const Near plates(pinch());
  for (const double z : {0., 1., 2.}) {
    for (const double force : {0., 1., 2.})
      EXPECT_FALSE(plates.prove(vector({0, z}), vector({force, 0, force, 0})).proven);
    EXPECT_FALSE(plates.none(vector({0, z}), 1e-3));
  }
}

}  // namespace
}  // namespace zwang
