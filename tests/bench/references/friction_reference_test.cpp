#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <zwang/bench/references/friction/coulomb.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/friction/solution_count.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/scenes/friction/families.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/referee/friction/natural_map.h>
#include "tests/core/referee/friction/small_frictional.h"

namespace zwang {
namespace {

using test::judge;

// Each rounded once, where none is missing.
std::optional<std::vector<Vector>> enumerated(const Problem& p) {
  const std::optional<ExactSolutions> all = enumerate_planar(p);
  if (!all || !all->complete()) return {};
  std::vector<Vector> z;
  for (const auto& solution : all->solutions()) z.push_back(solution.z);
  return z;
}

bool among(const Problem& p, const Vector& z, const std::vector<Vector>& all, double within) {
  return std::ranges::any_of(all, [&](const Vector& other) { return relative_distance(p, other, z) <= within; });
}

TEST(FrictionReference, FindsAndProvesAllThreeSolutionsOfTheRod) {
  const Problem p = rod_point(2).instance.problem;
  const std::vector<CoulombSolution> found = coulomb_solutions(p, {.random_starts = 40, .all = true});
  const std::optional<std::vector<Vector>> exact = enumerated(p);
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->size(), 3u);
  EXPECT_GE(found.size(), 2u);
  EXPECT_LE(found.size(), 3u);
  for (const CoulombSolution& s : found) {
    EXPECT_TRUE(among(p, s.z, *exact, 1e-15));
    EXPECT_TRUE(s.isolated);
    EXPECT_LE(s.radius, 1e-20);
    EXPECT_EQ(s.delta, 0);
  }
}

TEST(FrictionReference, ProvesNothingWhereThereIsNoSolution) {
  std::string why;
  EXPECT_TRUE(coulomb_solutions(jam_point(1, -1).instance.problem, {}, &why).empty());
  EXPECT_FALSE(why.empty());
}

TEST(FrictionReference, CountsTheSolutionsOfTheExactPoints) {
  for (const FrictionPoint& point : {rod_point(1), rod_point(1.5), rod_point(2), jam_point(.5, -1), jam_point(1, -1),
                                     jam_point(1, 1), held_point(.5), held_point(1), pinch_point()}) {
    const Problem& p = point.instance.problem;
    const SolutionCount count = count_solutions(p, 60);
    EXPECT_TRUE(count.by_enumeration);
    if (point.solutions < 0) {
      EXPECT_EQ(count.kind, SolutionCount::Kind::continuum) << p.name;
      for (const CoulombSolution& s : count.solutions) EXPECT_FALSE(s.isolated);
      continue;
    }
    EXPECT_EQ(count.kind, SolutionCount::Kind::all) << p.name;
    EXPECT_EQ(count.proven, static_cast<std::size_t>(point.solutions)) << p.name << in_words(count);
    for (const CoulombSolution& s : count.solutions) {
      EXPECT_TRUE(s.isolated) << p.name;
      EXPECT_LE(s.bound, 1e-15) << p.name;
    }
  }
}

// Without enumeration: what the searches prove of the rod, and of the puck, whose load may be split in many ways.
TEST(FrictionReference, CountsWhatItProvesWhereNothingIsEnumerated) {
  const SolutionCount puck = count_solutions(puck_point().instance.problem, 60);
  EXPECT_EQ(puck.kind, SolutionCount::Kind::continuum);
  EXPECT_FALSE(puck.by_enumeration);
  ASSERT_FALSE(puck.solutions.empty());
  EXPECT_EQ(puck.solutions[0].modes, std::vector(4, ContactMode::slide));
  EXPECT_TRUE(puck.solutions[0].free_split && !puck.solutions[0].isolated);

  const Problem rod = rod_point(2).instance.problem;
  const std::vector<CoulombSolution> found = coulomb_solutions(rod, {.mode_choices = 729, .all = true});
  EXPECT_EQ(found.size(), 3u);
  for (const CoulombSolution& s : found) EXPECT_FALSE(s.continuum);
}

// A load that may be split in many ways without moving anything is no continuum of z.
TEST(FrictionReference, AFreeSplitOfForcesThatMovesNothingIsOneSolution) {
  Problem p = rod_point(1).instance.problem;
  p.z_u[1] = -1;  // pressed on, and the contact stored twice
  const Index m = p.rows();
  Matrix J(2 * m, p.size());
  J << Matrix(p.J), Matrix(p.J);
  p.J = J.sparseView();
  p.c.conservativeResize(2 * m);
  p.mu.conservativeResize(2 * m);
  for (Index i = 0; i < m; ++i) {
    p.c[m + i] = p.c[i];
    p.mu[m + i] = p.mu[i];
    p.kind.push_back(p.kind[static_cast<std::size_t>(i)]);
    p.key.push_back({100 + static_cast<std::uint64_t>(i), 0});
  }
  const SolutionCount count = count_solutions(p, 60);
  EXPECT_EQ(count.kind, SolutionCount::Kind::all) << in_words(count);
  EXPECT_EQ(count.proven, 1u);
  for (const CoulombSolution& s : count.solutions) EXPECT_FALSE(s.continuum);
}

// Planar scenes of small integers: what is proven is a solution in rationals, the referee knows each of them, and what
// is none is never called solved.
TEST(FrictionReference, AgreesWithEnumerationOnPlanarScenes) {
  std::mt19937_64 random(7);
  const auto draw = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  int several = 0, proven = 0, all = 0, decided = 0, solutions = 0, by_slopes = 0, denied = 0, apart = 0;
  for (int scene = 0; scene < 300; ++scene) {
    const Index contacts = draw(1, 3), n = draw(2, 4);
    Problem p{.name = "planar", .z_u = Vector(n), .law = Law::coulomb};
    p.M = Matrix(Matrix::Identity(n, n)).sparseView();
    for (double& x : p.z_u) x = draw(-4, 4);
    Matrix J(2 * contacts, n);
    p.c = Vector::Zero(2 * contacts);
    p.mu = Vector::Zero(2 * contacts);
    for (Index i = 0; i < J.rows(); ++i) {
      for (Index j = 0; j < n; ++j) J(i, j) = draw(-2, 2);
      p.kind.push_back(i % 2 == 0 ? RowKind::inequality : RowKind::tangent);
      p.key.push_back({static_cast<std::uint64_t>(i / 2) + 1, static_cast<std::uint32_t>(i % 2)});
      p.c[i] = i % 2 == 0 ? draw(-2, 1) : draw(-1, 1);
      if (i % 2 == 0) p.mu[i] = draw(0, 8) / 4.0;
    }
    p.J = J.sparseView();
    const std::optional<std::vector<Vector>> exact = enumerated(p);
    if (!exact) continue;
    if (scene % 3 == 0) {
      const SolutionCount count = count_solutions(p, 60);  // throws where the searches contradict enumeration
      EXPECT_EQ(count.proven, exact->size()) << "scene " << scene;
      for (const CoulombSolution& s : count.solutions) EXPECT_FALSE(s.continuum) << "scene " << scene;
    }
    ++all;
    several += exact->size() > 1;
    for (const CoulombSolution& s : coulomb_solutions(p)) {
      ++proven;
      by_slopes += s.by_slopes;
      EXPECT_TRUE(among(p, s.z, *exact, 1e-11)) << "scene " << scene;
    }
    for (const Vector& z : *exact) {
      const Verdict verdict = judge(p, z).verdict;
      EXPECT_NE(verdict, Verdict::wrong) << "scene " << scene;
      decided += verdict == Verdict::solved;
      ++solutions;
    }
    Vector off = exact->empty() ? Vector(p.z_u) : exact->front();
    off[0] += .125;
    // M = I: distances are plain ones.
    const ScaledProblem scaled(p);
    const ContactProblem own(p, scaled, 1);
    for (const double far : {0x1p-3, 0x1p-10, 0x1p-20}) {
      Vector z = off;
      z[0] += far - .125;
      double least = exact->empty() ? 1 : std::numeric_limits<double>::infinity();
      for (const Vector& solution : *exact) least = std::min(least, (z - solution).norm());
      const auto none = [&](double distance) {
        return none_by_slopes(own, own.motion(z), std::ldexp(distance, -own.norm_exponent()));
      };
      EXPECT_FALSE(!exact->empty() && none(least * (1 + 1e-9))) << "scene " << scene;
      denied += none(least / 16);
      ++apart;
    }
    if (!among(p, off, *exact, 1e-9)) {
      EXPECT_NE(judge(p, off).verdict, Verdict::solved) << "scene " << scene;
    }
  }
  EXPECT_GE(all, 200);
  EXPECT_GE(several, 3);
  EXPECT_GE(proven, all * 3 / 4);
  RecordProperty("solutions", solutions);
  EXPECT_GE(decided, solutions / 2);
  EXPECT_GE(by_slopes, proven * 2 / 3);
  EXPECT_GE(denied, apart / 2);
}

TEST(FrictionReference, EnumeratesWhereAllRowsAreEqualities) {
  Problem p{.name = "equalities", .z_u = Vector::Constant(2, 1), .law = Law::coulomb};
  p.M = Matrix(Matrix::Identity(2, 2)).sparseView();
  p.J = Matrix(Matrix::Identity(2, 2)).sparseView();
  p.c = p.mu = Vector::Zero(2);
  p.kind.assign(2, RowKind::equality);
  p.key = {{1, 0}, {2, 0}};
  const std::optional<ExactSolutions> all = enumerate_planar(p);
  ASSERT_TRUE(all && all->complete());
  ASSERT_EQ(all->solutions().size(), 1u);
  EXPECT_EQ(all->solutions()[0].z, Vector::Zero(2));
  EXPECT_EQ(all->solutions()[0].lambda, Vector::Constant(2, -1));
}

TEST(FrictionReference, EnumeratesWithoutUnknowns) {
  Problem p{.name = "nothing", .law = Law::coulomb};
  p.M.resize(0, 0);
  p.J.resize(1, 0);
  p.c = Vector::Constant(1, -1);
  p.mu = Vector::Zero(1);
  p.kind = {RowKind::inequality};
  p.key = {{1, 0}};
  const std::optional<ExactSolutions> all = enumerate_planar(p);
  ASSERT_TRUE(all && all->complete());
  EXPECT_EQ(all->solutions().size(), 1u);
}

// With one tangent K* is the pyramid: the frictionless referee judges the same z by its own proofs.
TEST(FrictionReference, ConvexLawWithOneTangentIsThePyramid) {
  int judged = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Problem p = planted_friction({.bodies = 3, .contacts = 6, .tangents = 1, .mu = .5, .seed = seed}).problem;
    const Problem pyramid = under(Law::pyramid, p);
    p.law = Law::convex;
    const std::optional<Reference> found = convex_reference(p);
    if (!found) continue;
    EXPECT_LE(found->bound, 1e-9);
    const Metrics m = judge(pyramid, found->z);
    EXPECT_NE(m.verdict, Verdict::wrong) << seed;
    judged += m.verdict == Verdict::solved && m.z_bound <= 1e-12;
    EXPECT_EQ(judge(p, found->z).verdict, Verdict::solved) << seed;
    Vector off = found->z;
    off[0] += 1e-3;
    EXPECT_EQ(judge(p, off).verdict, Verdict::wrong) << seed;
  }
  EXPECT_GE(judged, 45);
}

// Where the interior point's iterates come to the answer along the outside of a cone.
TEST(FrictionReference, ConvexAnswersOfBoxesPushedSideways) {
  for (Instance& made : make_scenes("STKF(boxes=1..8)")) {
    made.problem.law = Law::convex;
    const std::optional<Reference> found = convex_reference(made.problem);
    ASSERT_TRUE(found) << made.problem.name;
    EXPECT_LE(found->bound, 1e-12) << made.problem.name;
  }
}

TEST(FrictionReference, EqualityRowsStayNative) {
  Instance planted = planted_friction({.bodies = 3, .contacts = 6, .mu = .5, .seed = 3});
  Problem& p = planted.problem;
  // One coordinate held at what it is in z*: z* stays a solution, with multiplier 0.
  const Index m = p.rows();
  Matrix J(m + 2, p.size());
  J << Matrix(p.J), Matrix::Zero(2, p.size());
  J(m, 0) = 1;
  J(m + 1, 0) = 2;  // twice: dependent, consistent
  p.J = J.sparseView();
  p.c.conservativeResize(m + 2);
  p.mu.conservativeResize(m + 2);
  p.c[m] = planted.reference->z[0];
  p.c[m + 1] = 2 * planted.reference->z[0];
  for (Index i = m; i < m + 2; ++i) {
    p.mu[i] = 0;
    p.kind.push_back(RowKind::equality);
    p.key.push_back({1000 + static_cast<std::uint64_t>(i), 0});
  }
  EXPECT_EQ(judge(p, planted.reference->z).verdict, Verdict::solved);
  const std::optional<Reference> found = coulomb_reference(p);
  ASSERT_TRUE(found);
  EXPECT_LE(std::abs(found->z[0] - planted.reference->z[0]), 1e-14);
  EXPECT_FALSE(found->unique);
}

}  // namespace
}  // namespace zwang
