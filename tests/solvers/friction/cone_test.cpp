// What `cone` promises on contacts with friction, beyond the contract of all solvers.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/friction/cone.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/friction/friction_problems.h"

namespace zwang {
namespace {

using test::friction_problem;
using test::FrictionRow;
using test::law_error;
using test::planted;

constexpr RowKind equality = RowKind::equality, inequality = RowKind::inequality, tangent = RowKind::tangent;

Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

Cone cone() {
  Cone cone;
  cone.without_friction = {DualActiveSet(), make_solver("newton")};
  return cone;
}

Solution solve(const Problem& p, Cone settings = cone(), const SolveOptions& options = {}) {
  AnySolver solver = settings;
  return solver.solve(p, options);
}

// A body on the ground, z = (normal, t1, t2).
Problem block(double mu, const Vec3& z_u, Law law) {
  return friction_problem(
      vec({1, 1, 1}), z_u,
      {{inequality, vec({1, 0, 0}), 0, mu}, {tangent, vec({0, 1, 0}), 0}, {tangent, vec({0, 0, 1}), 0}}, law);
}

TEST(Cone, ABlockSticksSlidesAndLifts) {
  for (const Law law : {Law::convex, Law::coulomb}) {
    Solution s = solve(block(0.5, Vec3(-8, 1.5, 2), law));
    ASSERT_EQ(s.status, Status::solved) << s.message;
    EXPECT_LE(s.z.norm(), 1e-14);
    EXPECT_LE((s.lambda - vec({8, -1.5, -2})).norm(), 1e-13);
    s = solve(block(0.5, Vec3(1, 3, 4), law));
    ASSERT_EQ(s.status, Status::solved) << s.message;
    EXPECT_LE((s.z - vec({1, 3, 4})).norm(), law == Law::coulomb ? 1e-15 : 3);
  }
  // Free slip 10, approach 8: Coulomb stops mu a of the slip; the convex law lifts the body (friction.md's sliding
  // block).
  const Solution coulomb = solve(block(0.5, Vec3(-8, 6, 8), Law::coulomb));
  ASSERT_EQ(coulomb.status, Status::solved) << coulomb.message;
  EXPECT_LE((coulomb.z - vec({0, 3.6, 4.8})).norm(), 1e-13);
  const Solution convex = solve(block(0.5, Vec3(-8, 6, 8), Law::convex));
  ASSERT_EQ(convex.status, Status::solved) << convex.message;
  const double slip = (10 - 0.5 * 8) / 1.25;
  EXPECT_LE((convex.z - vec({0.5 * slip, 0.6 * slip, 0.8 * slip})).norm(), 1e-13);
}

TEST(Cone, WeakAndStrongFriction) {
  for (const double mu : {1e-10, 1e-8, 1e-4, 1e4, 1e6}) {
    const double slip = std::max(0.0, 10 - mu * 8), lift = mu < 1 ? mu * slip / (1 + mu * mu) : 0;
    const Solution coulomb = solve(block(mu, Vec3(-8, 6, 8), Law::coulomb));
    ASSERT_EQ(coulomb.status, Status::solved) << mu << ": " << coulomb.message;
    EXPECT_LE((coulomb.z - slip * vec({0, .6, .8})).norm(), 1e-11) << mu;
    const Solution convex = solve(block(mu, Vec3(-8, 6, 8), Law::convex));
    ASSERT_EQ(convex.status, Status::solved) << mu << ": " << convex.message;
    EXPECT_LE((convex.z - (slip / (1 + mu * mu) * vec({0, .6, .8}) + vec({lift, 0, 0}))).norm(), 1e-11) << mu;
  }
}

TEST(Cone, PlantedAnswersOfBothLawsAreMet) {
  int solved = 0, planted_one = 0;
  for (unsigned seed = 0; seed < 60; ++seed)
    for (const double mu : {0x1p-6, 0.25, 1.0}) {
      for (const Law law : {Law::convex, Law::coulomb}) {
        const auto [p, z, lambda] =
            planted(law, mu, 1 + static_cast<int>(seed % 4), 2 + static_cast<int>(seed % 6), seed);
        const Solution s = solve(p);
        if (law == Law::convex) {
          ASSERT_EQ(s.status, Status::solved) << seed << " " << mu << ": " << s.message;
          EXPECT_LE((s.z - z).norm(), 1e-9 * z.norm()) << seed << " " << mu;
        }
        if (s.status != Status::solved) continue;
        ++solved;
        planted_one += (s.z - z).norm() <= 1e-9 * z.norm();
        EXPECT_LE(law_error(p, s), 1e-11) << seed << " " << mu << " " << to_string(s.status);
      }
    }
  EXPECT_GE(solved, 355);  // of 360; Coulomb's law may have other answers, or be hard
  EXPECT_GE(planted_one, 300);
}

TEST(Cone, NoFrictionIsAnExactCaseAndNoLimit) {
  const Problem p = block(0, Vec3(-8, 6, 8), Law::coulomb);
  const Solution s = solve(p);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_EQ(s.lambda[1], 0);
  EXPECT_EQ(s.lambda[2], 0);
  EXPECT_LE((s.z - vec({0, 6, 8})).norm(), 1e-14);
  // And nearly none is near to it.
  for (int k = 10; k <= 40; k += 10) {
    const Solution near = solve(block(std::ldexp(1.0, -k), Vec3(-8, 6, 8), Law::coulomb));
    ASSERT_EQ(near.status, Status::solved) << k << ": " << near.message;
    EXPECT_LE((near.z - vec({0, 6, 8})).norm(), 2 * std::ldexp(8.0, -k) + 1e-14) << k;
  }
}

TEST(Cone, OneTangentAndLimitsAndJointsStandBesideEachOther) {
  // In the plane, with a row that ties t2 to t1, a limit on t1 and a contact with one tangent: z = (n, t1, t2).
  const Problem p = friction_problem(vec({1, 2, 2}), vec({-4, 3, 3}),
                                     {{equality, vec({0, 1, -1}), 0},
                                      {inequality, vec({1, 0, 0}), 0, 0.25},
                                      {tangent, vec({0, 1, 0}), 0},
                                      {inequality, vec({0, 0, -1}), -1}});
  const Solution s = solve(p);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE(law_error(p, s), 1e-13);
  EXPECT_LE((s.z - vec({0, 1, 1})).norm(), 1e-12);  // slides up to its limit, friction 1 of the 8 on the way
  EXPECT_NEAR(s.lambda[1], 4, 1e-12);
  EXPECT_NEAR(s.lambda[2], -1, 1e-12);
  EXPECT_NEAR(s.lambda[3], 7, 1e-12);
}

TEST(Cone, BodiesThatCannotMoveAreData) {
  // A contact whose rows are all zero: Coulomb asks for c_n <= 0 only, the convex law for -c_n >= mu |c_t|.
  const auto immobile = [](double c_n, double c_t, Law law) {
    return friction_problem(vec({1, 1, 1}), vec({-1, 0, 0}),
                            {{inequality, vec({0, 0, 0}), c_n, 1},
                             {tangent, vec({0, 0, 0}), c_t},
                             {tangent, vec({0, 0, 0}), 0},
                             {inequality, vec({1, 0, 0}), 0, 0.5},
                             {tangent, vec({0, 1, 0}), 0},
                             {tangent, vec({0, 0, 1}), 0}},
                            law);
  };
  EXPECT_EQ(solve(immobile(-1, 2, Law::coulomb)).status, Status::solved);
  EXPECT_EQ(solve(immobile(-2, 1, Law::convex)).status, Status::solved);
  EXPECT_EQ(solve(immobile(1, 0, Law::coulomb)).status, Status::infeasible);
  const Solution s = solve(immobile(-1, 2, Law::convex));
  ASSERT_EQ(s.status, Status::infeasible);
  EXPECT_GT(s.certificate.dot(immobile(-1, 2, Law::convex).c), 0);
  // Tangents that do not move, under a normal that does: the belt's speed is data.
  const Problem belt =
      friction_problem(vec({1, 1}), vec({-2, 0}), {{inequality, vec({1, 0}), 0, 0.5}, {tangent, vec({0, 0}), -3}});
  const Solution b = solve(belt);
  ASSERT_EQ(b.status, Status::solved) << b.message;
  EXPECT_LE(law_error(belt, b), 1e-12);
  EXPECT_NEAR(b.lambda[1], -1, 1e-10);
  // c = -Inf at the normal row takes the whole contact out.
  Problem out = block(0.5, Vec3(-8, 6, 8), Law::coulomb);
  out.c[0] = -infinity;
  const Solution o = solve(out);
  ASSERT_EQ(o.status, Status::solved) << o.message;
  EXPECT_EQ(o.z, out.z_u);
}

TEST(Cone, RowsThatContradictEachOtherHaveAProof) {
  // Two walls that move into a body from both sides: no motion, under either law, and normals alone say so.
  for (const Law law : {Law::convex, Law::coulomb}) {
    const Problem p = friction_problem(vec({1, 1, 1}), vec({0, 0, 0}),
                                       {{inequality, vec({1, 0, 0}), 1, 0.5},
                                        {tangent, vec({0, 1, 0}), 0},
                                        {tangent, vec({0, 0, 1}), 0},
                                        {inequality, vec({-1, 0, 0}), 1, 0.5},
                                        {tangent, vec({0, 1, 0}), 0},
                                        {tangent, vec({0, 0, 1}), 0}},
                                       law);
    const Solution s = solve(p);
    ASSERT_EQ(s.status, Status::infeasible) << to_string(s.status) << s.message;
    const Vector& u = s.certificate;
    EXPECT_LE((p.J.transpose() * u).norm(), 1e-8 * p.c.dot(u));
    for (const Index i : {0, 3}) EXPECT_GE(p.mu[i] * u[i], std::hypot(u[i + 1], u[i + 2]) - 1e-12 * u.norm());
  }
}

// PINCH of the notes: plates that slide past each other. No convex answer; Coulomb has a continuum, any of which will
// do.
TEST(Cone, ThePinchIsInfeasibleUnderTheConvexLawOnly) {
  const auto pinch = [](Law law) {
    return friction_problem(vec({1, 1}), vec({0, 3}),
                            {{inequality, vec({1, 0}), 0, 1},
                             {tangent, vec({0, 1}), 1},
                             {inequality, vec({-1, 0}), 0, 1},
                             {tangent, vec({0, 1}), -1}},
                            law);
  };
  EXPECT_EQ(solve(pinch(Law::convex)).status, Status::infeasible);
  const Solution s = solve(pinch(Law::coulomb));
  EXPECT_NE(s.status, Status::infeasible);
  if (s.status == Status::solved) {
    EXPECT_LE(law_error(pinch(Law::coulomb), s), 1e-8);
  }
}

// In the unit of its tangents this row is nothing, whatever it pushes and however far it is open.
TEST(Cone, AContactThatPushesAndIsOpenIsNotSolved) {
  const Problem p =
      friction_problem(vec({1, 1, 1}), vec({3, 3, 0}),
                       {{inequality, vec({-1, -1, 3}) / 8, 1, 1}, {tangent, vec({-3, 3, 2}) * 0x1p19, 0}});
  for (const char* solver : {"cone", "nsgs", "fixed_point", "admm", "alart_curnier"}) {
    const Solution s = make_solver(solver).solve(p, {.tolerance = 1e-10});
    ASSERT_EQ(s.z.size(), p.size()) << solver;
    const double open = p.J.row(0).dot(s.z) - p.c[0];
    EXPECT_TRUE(s.status != Status::solved || open * std::min(1.0, s.lambda[0]) <= 1e-8) << solver;
  }
}

// JAM: no answer beyond mu = 3/4, and nobody may claim one.
TEST(Cone, AJamWithoutAnswerIsNotSolved) {
  const auto jam = [](double mu, double c_t) {
    return friction_problem(vec({1, 1}), vec({0, -1}),
                            {{inequality, vec({-4, 3}) / 5, 0, mu},
                             {tangent, vec({3, 4}) / 5, c_t / 5},
                             {inequality, vec({4, 3}) / 5, 0, mu},
                             {tangent, vec({-3, 4}) / 5, c_t / 5}});
  };
  const Solution s = solve(jam(0.5, -1));
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_LE(s.z.norm(), 1e-10);
  EXPECT_NE(solve(jam(1, -1)).status, Status::solved);
}

// Forces of 2^k times the motion hide slacks 1e5 times as far from the answer as the residual says.
TEST(Cone, NoConvexAnswerIsClaimedThatTheForcesHide) {
  for (const char* scene : {"JAM(k=11)", "JAM(k=20)", "JAM(k=22)", "JAM(k=24)", "HELD(k=38)"}) {
    Problem p = make_scenes(scene).at(0).problem;
    p.law = Law::convex;
    const Solution s = solve(p);
    EXPECT_TRUE(s.status != Status::solved || measure(p, s, nullptr, 1e-10).verdict == Verdict::solved) << scene;
    EXPECT_EQ(s.status == Status::solved, scene == std::string("JAM(k=11)")) << scene;
  }
}

// Where the path points both ends fit the modes to the last digit, friction of 2^-40 among them: a motion and forces
// that are 2e-7 apart.
TEST(Cone, NoMotionIsClaimedThatTheForcesDoNotMake) {
  const double weak = std::ldexp(1.0, -27), weaker = std::ldexp(1.0, -40), strong = 1024;
  const std::vector<FrictionRow> rows{{inequality, vec({-2, -2, 0, 0, -2, -1, -1, 2}), -2.1875, 0.75},
                                      {tangent, vec({0, 1, -1, -2, -2, 0, 0, 1}), 1.9375},
                                      {inequality, vec({-1, 2, 0, -1, 0, -1, -1, -1}), -0.375, weak},
                                      {tangent, vec({-1, -2, 2, 0, -2, -1, 0, 1}), 0.75},
                                      {tangent, vec({2, 1, 1, 1, 0, 2, -1, -1}), 0.8125},
                                      {inequality, vec({0, -1, -1, -1, -2, 0, 0, -1}), -1.5, weaker},
                                      {tangent, vec({-2, -1, -2, 2, -2, 2, 0, -1}), -5.375},
                                      {tangent, vec({-2, -1, -2, 2, -2, 2, 0, -1}), -5.375},
                                      {inequality, vec({0, 0, 0, 0, -1, 0, 2, 0}), 2.125, strong},
                                      {tangent, vec({-2, 2, 0, 2, -2, 0, -1, -2}), -2.8125}};
  const Vector z = vec({0.875, 0.625, 0.8125, -0.4375, -0.25, -0.25, 0.9375, 0.5});
  const Vector lambda = vec({0, 0, 0.625, -weak / 8, 0.75 * weak / 8, 0, 0, 0, 0.25, 64});
  Problem p = friction_problem(Vector::Ones(8), z, rows, Law::coulomb);
  p.z_u -= p.J.transpose() * lambda;
  Solution planted{.z = z, .lambda = lambda};
  ASSERT_LE(law_error(p, planted), 1e-15);
  const Solution s = solve(p);
  EXPECT_TRUE(s.status != Status::solved || law_error(p, s) <= 1e-9);
}

// A box on one that is 2^24 times lighter, on four corners each: no start leads to an answer, convex problems do. From
// 2^36 on rounding is too far from z for a claim.
TEST(Cone, GoesByConvexProblemsWhereNoStartLeads) {
  for (const char* scene : {"MRF(k=24)", "MRF(k=28)"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    const Solution s = solve(p, cone(), {.tolerance = 1e-12});
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_TRUE(s.fallback) << scene;
    EXPECT_EQ(measure(p, s, nullptr, 1e-12).verdict, Verdict::solved) << scene;
  }
  EXPECT_NE(solve(make_scenes("MRF(k=40)").at(0).problem, cone(), {.tolerance = 1e-12}).status, Status::solved);
}

// Forces that grow like 2^k leave a gap that bounds nothing: what the bound of promises says of the best iterate
// counts.
TEST(Cone, ABoundTellsOfAnAnswerWhereTheGapDoesNot) {
  const auto check = [](const char* scene, Law law, bool may_fail) {
    const Problem p = under(law, make_scenes(scene).at(0).problem);
    const Solution s = solve(p, cone(), {.tolerance = 1e-10});
    if (may_fail && s.status == Status::numerical_failure) return;
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_TRUE(std::isnan(s.error_bound)) << "nobody asked";
    EXPECT_EQ(measure(p, s, nullptr, 1e-10).verdict, Verdict::solved) << scene;
  };
  check("JAM(k=20)", Law::coulomb, false);
  check("MUL(k=8)", Law::convex, false);
#ifdef __FMA__
  constexpr bool fused = true;
#else
  constexpr bool fused = false;  // 5e-10 stays, and it says so
#endif
  check("MUL(k=9)", Law::convex, !fused);
}

// More than a thousand unknowns: by sparse LU where Coulomb's shift has to be differentiated.
TEST(Cone, SolvesLargePilesStacksAndWallsUnderCoulombsLaw) {
  for (const char* scene : {"pile(spheres=200,mu=0.5,seed=3)", "pile(spheres=250,mu=0.5,seed=3)",
                            "stack(boxes=200,push=1,mu=0.5)", "wall(boxes=300,mu=0.5,push=1,seed=2)"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    ASSERT_GT(p.size(), 1000) << scene;
    const Solution s = solve(p);
    ASSERT_EQ(s.status, Status::solved) << scene << ": " << s.message;
    EXPECT_TRUE(s.fallback) << scene;
    const Metrics m = measure(p, s, nullptr, 1e-8);
    EXPECT_NE(m.verdict, Verdict::wrong) << scene;
    EXPECT_LE(m.natural, 1e-10) << scene;
    EXPECT_LE(m.friction.eta, 1e-10) << scene;
  }
}

// Fifteen contacts of one body, of rank 6 in 45 rows, that agree, or disagree by 1e-8. No hundred iterations on them.
TEST(Cone, ContactsThatDependOnEachOtherEndSoonAndClaimOnlyWhatHolds) {
  int solved = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    for (const double off : {0.0, std::ldexp(1.0, -27)}) {
      test::Planted made = planted(Law::coulomb, 0.75, 1, 15, seed);
      for (Index i = 0; i < made.problem.rows(); ++i)
        if (i % 5 == 1) made.problem.c[i] += off;
      const Solution s = solve(made.problem, cone(), {.max_iterations = 100});
      EXPECT_LE(s.iterations, 100) << seed;
      ASSERT_EQ(s.z.size(), 6) << seed << ' ' << s.message;
      if (s.status != Status::solved) continue;
      ++solved;
      EXPECT_LE(law_error(made.problem, s), 1e-9) << seed << ", off by " << off;
    }
  }
  EXPECT_GE(solved, 45);
}

TEST(Cone, TheSameBitsTwiceAndNothingAllocated) {
  for (const Law law : {Law::convex, Law::coulomb}) {
    const Problem p = planted(law, 0.5, 4, 8, 7).problem;
    AnySolver solver = cone();
    Solution first, second;
    solver.solve(p, {}, first);
    solver.solve(p, {}, second);
    const long before = allocations();
    solver.solve(p, {}, second);
    EXPECT_EQ(allocations() - before, 0);
    ASSERT_EQ(first.status, second.status);
    EXPECT_EQ(0, std::memcmp(first.z.data(), second.z.data(), sizeof(double) * static_cast<std::size_t>(p.size())));
    EXPECT_EQ(
        0, std::memcmp(first.lambda.data(), second.lambda.data(), sizeof(double) * static_cast<std::size_t>(p.rows())));
  }
}

// Under Coulomb's law the central path may turn back, and the next try goes on from there: in the same problem only.
TEST(Cone, AProblemKnowsNothingOfTheOneBefore) {
  AnySolver used = cone();
  Solution s;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const int contacts = 6 + static_cast<int>(seed % 8);
    used.solve(planted(Law::coulomb, 1, 2, contacts, seed).problem, {}, s);
    for (const Law law : {Law::convex, Law::coulomb}) {
      const Problem larger = planted(law, 0.5, 4, contacts + 2, 100 + seed).problem;
      const Solution fresh = solve(larger);
      used.solve(larger, {}, s);
      EXPECT_EQ(s.status, fresh.status) << seed;
      EXPECT_EQ(s.iterations, fresh.iterations) << seed;
      EXPECT_TRUE(s.z == fresh.z && s.lambda == fresh.lambda) << seed;
    }
  }
}

// What is to be handed on, and has nowhere to go, is refused.
TEST(Cone, WithoutASolverOfQuadraticProgramsAPartWithoutFrictionIsUnsupported) {
  Problem loose = friction_problem(vec({1}), vec({-1}), {{inequality, vec({1}), 0}}, Law::frictionless);
  loose.mu.resize(0);
  EXPECT_EQ(solve(loose, Cone()).status, Status::unsupported);
  EXPECT_EQ(solve(loose).status, Status::solved);
  EXPECT_EQ(solve(loose).handed_to, "dual_active_set");
}

// Two blocks without any more unknowns, as a Delassus matrix gives them: seven unknowns are no bodies.
TEST(Cone, PartsOfAProblemWithoutBodiesAreSolvedApart) {
  const Problem slides = block(0.5, Vec3(-1, 3, 0), Law::coulomb), sticks = block(0.5, Vec3(-2, 0.5, 0), Law::coulomb);
  Problem both = slides;
  both.z_u = Vector::Zero(7);
  both.z_u << slides.z_u, sticks.z_u, 2;
  both.M.resize(7, 7);
  both.M.setIdentity();
  Matrix J = Matrix::Zero(6, 7);
  J.topLeftCorner(3, 3) = Matrix(slides.J);
  J.block(3, 3, 3, 3) = Matrix(sticks.J);
  both.J = J.sparseView();
  both.c = Vector::Zero(6);
  both.mu = Vector::Zero(6);
  both.mu[0] = both.mu[3] = 0.5;
  for (Index i = 0; i < 3; ++i) both.kind.push_back(both.kind[static_cast<std::size_t>(i)]);
  for (std::uint64_t i = 0; i < 3; ++i) both.key.push_back({100 + i, 0});
  AnySolver solver = cone();
  Solution s;
  solver.solve(both, {}, s);
  ASSERT_EQ(s.status, Status::solved) << s.message;
  EXPECT_EQ(s.z.head(3), solve(slides).z);
  EXPECT_EQ(s.z.segment(3, 3), solve(sticks).z);
  EXPECT_EQ(s.z[6], 2);
  EXPECT_FALSE(s.fallback);
  solver.solve(both, {}, s);
  const long before = allocations();
  solver.solve(both, {}, s);
  EXPECT_EQ(allocations() - before, 0);
}

TEST(Cone, AWarmStartTakesFewerFactorizations) {
  for (const Law law : {Law::convex, Law::coulomb}) {
    Problem p = planted(law, 0.5, 3, 6, 3).problem;
    const Solution cold = solve(p);
    ASSERT_EQ(cold.status, Status::solved) << cold.message;
    const WarmStart warm{p.key, cold.lambda};
    p.z_u *= 1.001;
    const Solution s = solve(p, cone(), {.warm_start = &warm});
    ASSERT_EQ(s.status, Status::solved) << s.message;
    EXPECT_LT(s.iterations, cold.iterations);
    EXPECT_LE(law_error(p, s), 1e-11);
  }
}

// A finger tip on a surface of fine triangles: eight contacts at one place whose normals and gaps are almost the same.
// An earlier answer says that all of them carry; one or two do.
TEST(Cone, LoadGoesOverToTheRowsThatCarry) {
  for (const Law law : {Law::convex, Law::coulomb})
    for (const double tilt : {1e-3, 1e-5, 1e-7}) {
      std::vector<test::FrictionRow> rows;
      WarmStart warm;
      for (int k = 0; k < 8; ++k) {
        const double a = tilt * (k - 3.3), b = tilt * ((5 * k) % 8 - 3.1);
        const Vec3 n = Vec3(1, a, b).normalized(), t = n.cross(Vec3::UnitZ()).normalized(), u = n.cross(t);
        rows.push_back({inequality, n, 1e-6 * tilt * ((3 * k) % 8), 0.5});
        rows.push_back({tangent, t, 0});
        rows.push_back({tangent, u, 0});
      }
      const Problem p = friction_problem(vec({1, 1, 1}), Vec3(-8, 6, 2), rows, law);
      warm.key = p.key;
      warm.lambda.setZero(p.rows());
      for (Index i = 0; i < p.rows(); i += 3) warm.lambda[i] = 1, warm.lambda[i + 1] = 0.4;
      const Solution s = solve(p, cone(), {.warm_start = &warm});
      ASSERT_EQ(s.status, Status::solved) << tilt << ' ' << s.message;
      EXPECT_LE(s.iterations, 32) << tilt;  // without an interior point
      EXPECT_LE(law_error(p, s), 1e-11) << tilt;
    }
}

TEST(Cone, LimitsEndTheSolveWithAnIterate) {
  const Problem p = planted(Law::coulomb, 0.5, 4, 8, 7).problem;
  EXPECT_EQ(solve(p, cone(), {.max_iterations = 2}).status, Status::iteration_limit);
  EXPECT_EQ(solve(p, cone(), {.time_limit = 0}).status, Status::time_limit);
  int shown = 0;
  SolveOptions options;
  options.observe = [&](int, const Vector& z, const Vector&) { shown += z.allFinite(); };
  const Solution s = solve(p, cone(), options);
  EXPECT_GE(shown, s.iterations / 2);
}

TEST(Cone, IslandsAreSolvedApart) {
  const auto one = planted(Law::coulomb, 0.5, 1, 3, 1), two = planted(Law::coulomb, 0.5, 1, 4, 2);
  Problem both;
  const Index n = 12, m = one.problem.rows() + two.problem.rows();
  both.M.resize(n, n);
  both.J.resize(m, n);
  both.z_u.resize(n);
  both.c.resize(m);
  both.mu.resize(m);
  both.law = Law::coulomb;
  Index row = 0, column = 0;
  for (const Problem* p : {&one.problem, &two.problem}) {
    for (Index j = 0; j < 6; ++j) both.M.insert(column + j, column + j) = p->M.coeff(j, j);
    for (Index i = 0; i < p->rows(); ++i)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p->J, i); it; ++it)
        both.J.insert(row + i, column + it.col()) = it.value();
    both.z_u.segment(column, 6) = p->z_u;
    both.c.segment(row, p->rows()) = p->c;
    both.mu.segment(row, p->rows()) = p->mu;
    both.kind.insert(both.kind.end(), p->kind.begin(), p->kind.end());
    row += p->rows();
    column += 6;
  }
  for (Index i = 0; i < m; ++i) both.key.push_back({static_cast<std::uint64_t>(i + 1), 0});
  both.M.makeCompressed();
  both.J.makeCompressed();
  const Solution whole = solve(both), first = solve(one.problem), second = solve(two.problem);
  ASSERT_EQ(whole.status, Status::solved) << whole.message;
  EXPECT_EQ(whole.iterations, first.iterations + second.iterations);
  EXPECT_EQ(whole.z.head(6), first.z);
  EXPECT_EQ(whole.z.tail(6), second.z);
}

// Two of the normals contradict each other, and friction pushes ever harder: next to so long a motion no row is
// violated.
TEST(Cone, AMotionWithoutEndIsNoAnswer) {
  const Problem p = friction_problem(vec({1, 0.5}), vec({1, -2}),
                                     {{inequality, vec({1, 0}), 0.5},
                                      {tangent, vec({0, -1}), 0},
                                      {inequality, vec({-1, 0}), 0, 1},
                                      {tangent, vec({-1, 1}), 0},
                                      {inequality, vec({0, 1}), -0.5, 1},
                                      {tangent, vec({0, 0}), 0},
                                      {inequality, vec({1, 1}), 0, 0.75},
                                      {tangent, vec({-1, 0}), 0}});
  const Solution s = solve(p);
  ASSERT_EQ(s.status, Status::infeasible) << s.message;
  EXPECT_GT(s.certificate.dot(p.c), 0);
}

}  // namespace
}  // namespace zwang
