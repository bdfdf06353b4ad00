#include <zwang/bench/references/judge.h>

#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/files/problem_file.h>
#include "tests/core/referee/friction/attacks.h"
#include "tests/folders.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::SmallFrictional;
using test::vector;

bool called_right(Verdict v) { return v == Verdict::solved || v == Verdict::near || v == Verdict::consistent; }

// Also not where a file says that the answer is right.
TEST(Judge, NoAttackSucceeds) {
  for (const test::Attack& a : test::attacks())
    for (const bool told : {false, true}) {
      constexpr double tolerance = 1e-8;
      Instance in{.problem = a.problem};
      if (told) in.reference = Reference{.z = a.z, .lambda = a.lambda, .hearsay = true, .method = "file"};
      const Judgement j = judge(in, a.z, a.lambda, tolerance);
      EXPECT_EQ(a.falsehood(j.verdict, tolerance, j.at_least, j.at_most), "")
          << a.name << (told ? ", told" : "") << ", off by " << a.off() << ": " << j.text;
    }
}

// Walls that leave x >= 1 and x <= 1 - overlap: there is no z.
Instance overlapping_walls(double overlap) {
  return {.problem = SmallFrictional{.z_u = vector({0, 0})}
                         .contact(1, {{vector({1, 0}), 1}, {vector({0, 1}), 0}})
                         .contact(1, {{vector({-1, 0}), overlap - 1}, {vector({0, 1}), 0}})
                         .problem()};
}

TEST(Judge, CallsNothingSolvedWhereThereIsNoSolution) {
  for (const double overlap : {1., 0x1p-10, 0x1p-30})
    for (const Vector& lambda : {Vector(), vector({1, 0, 0, 0})}) {
      const Judgement j = judge(overlapping_walls(overlap), vector({1, 0}), lambda, 1e-8);
      EXPECT_FALSE(called_right(j.verdict)) << overlap << ' ' << j.text;
      EXPECT_FALSE(j.at_most < 1e300) << overlap << ' ' << j.text;
    }
}

// z = z_u falls through the floor by 7 % of the motion, and no force is given.
TEST(Judge, KeepsWhatMeasureSaysOfAMotionThroughAWall) {
  const Instance falls{.problem = test::block(4, .3, .5).problem()};
  const Judgement j = judge(falls, vector({4, 0, -.3}), vector({0, 0, 0}), 1e-8);
  EXPECT_EQ(j.verdict, Verdict::wrong) << j.text;
  EXPECT_LE(j.at_least, j.at_most) << j.text;
}

// Two rows that open a wedge of 1e-100: only rationals tell that the answer is its corner, at a distance of 1.
TEST(Judge, SaysHowFarOffAWrongAnswerIsAtLeast) {
  const Instance wedge{.problem = test::make_problem(
                           vector({1, 1}), vector({-1, 0}),
                           {{RowKind::inequality, vector({0, 1}), 0}, {RowKind::inequality, vector({1e-100, -1}), 0}})};
  const Judgement j = judge(wedge, vector({-1, 0}), Vector(), 1e-8);
  EXPECT_EQ(j.verdict, Verdict::wrong) << j.text;
  EXPECT_NEAR(j.at_least, 1, 1e-8) << j.text;
}

// Without unknowns a row that cannot hold is all there is.
TEST(Judge, TakesFrictionWithoutUnknowns) {
  Problem p = SmallFrictional{.z_u = vector({0})}.contact(.5, {{vector({0}), 1}, {vector({0}), 0}}).problem();
  p.M.resize(0, 0);
  p.z_u.resize(0);
  p.J.resize(2, 0);
  EXPECT_FALSE(called_right(judge(Instance{.problem = p}, Vector(), Vector::Zero(2), 1e-8).verdict));
}

// Painleve's rod, mu = 2: it opens, slides or sticks, in rationals.
TEST(Judge, CallsNoneOfSeveralSolutionsWrong) {
  const Instance rod{.problem = test::rod(2)};
  for (const Vector& z : {vector({2, .25, 0}), vector({1.75, .375, -.375})}) {
    const Judgement j = judge(rod, z, {}, 1e-8);
    EXPECT_EQ(j.verdict, Verdict::solved) << j.text;
    EXPECT_EQ(j.at_least, 0) << j.text;
    EXPECT_LE(j.at_most, 1e-12) << j.text;
  }
}

// Hearsay of 303 unknowns, beyond what was once looked at: z off by half the motion, or none at all. z* = 0.
TEST(Judge, BelievesNoFileThatTheRefereeRefutes) {
  Instance tower{.problem = test::tower(303)};
  const Vector z = Vector::Zero(303);
  const double s = std::sqrt(tower.problem.z_u.dot(tower.problem.M * tower.problem.z_u));
  Vector off = z;
  off[0] = s / 2;
  for (const Reference& told : {Reference{.z = off, .hearsay = true, .method = "file"},
                                Reference{.feasible = false, .hearsay = true, .method = "file"}}) {
    tower.reference = told;
    EXPECT_FALSE(reference_for(tower, {}).reference);
    EXPECT_EQ(judge(tower, z, {}, 1e-8).verdict, Verdict::solved);
    EXPECT_EQ(judge(tower, off, {}, 1e-8).verdict, Verdict::wrong);
  }
  tower.reference = Reference{.z = z, .hearsay = true, .method = "file"};
  ASSERT_TRUE(reference_for(tower, {}).reference);
  EXPECT_EQ(judge(tower, z, {}, 1e-8).verdict, Verdict::solved);
}

// PINCH and the rod through a file: that there are other solutions is not lost, and that there are none not believed.
TEST(Judge, AFileDoesNotMakeOneOfSeveralSolutionsTheOnlyOne) {
  const std::filesystem::path file = own_path("judge-test.h5");
  const auto stored = [&](const Problem& problem, const Vector& z, bool unique) {
    Instance out{.problem = problem};
    out.reference = Reference{.z = z, .unique = unique, .method = "known answer"};
    write_problem(file, out);
    Instance read = read_problems(file).front();
    std::filesystem::remove(file);
    EXPECT_EQ(read.reference->unique, unique);
    return read;
  };
  for (const bool unique : {false, true}) {
    const Instance rod = stored(test::rod(2), vector({1.75, .375, -.375}), unique);
    EXPECT_EQ(judge(rod, vector({2, .25, 0}), {}, 1e-8).verdict, Verdict::solved);
    const Instance pinch = stored(test::pinch(), vector({0, 3}), unique);
    EXPECT_NE(judge(pinch, vector({0, 1}), {}, 1e-8).verdict, Verdict::wrong);
  }
}

// Every law, one and several solutions, redundant rows, no solution at all: what a file keeps of a reference decides as
// the scene's own does, for the stored answer, without multipliers, and spoilt.
TEST(Judge, AProblemReadBackIsJudgedAsBefore) {
  const std::filesystem::path file = own_path("judge-back.h5");
  int answers = 0;
  for (const char* scenes :
       {"stack(boxes=2),hand(contacts=4),leash,MR,NPE,LOOP,INC", "stack(boxes=2,mu=0.5),RANK,ROD,HELD,JAM,PINCH,PUCK"})
    for (Instance in : make_scenes(scenes)) {
      in.reference = reference_for(in, {}).reference;
      write_problem(file, in);
      const Instance back = read_problems(file).front();
      std::filesystem::remove(file);
      ASSERT_EQ(back.reference.has_value(), in.reference.has_value()) << in.family;
      const Problem& p = in.problem;
      std::vector<std::pair<Vector, Vector>> given = {{p.z_u, {}}};
      if (in.reference && in.reference->feasible) {
        const Vector& z = in.reference->z;
        given.emplace_back(z, in.reference->lambda);
        for (const double spoilt : {0., 1e-10, 1e-4}) given.emplace_back(z + spoilt * (p.z_u - z), Vector());
      }
      for (const auto& [z, lambda] : given) {
        const Judgement now = judge(in, z, lambda, 1e-8), then = judge(back, z, lambda, 1e-8);
        EXPECT_EQ(then.verdict, now.verdict) << in.family << ": " << now.text << " / " << then.text;
        EXPECT_EQ(then.at_least, now.at_least) << in.family << ": " << now.text << " / " << then.text;
        EXPECT_TRUE(then.at_most == now.at_most || (std::isnan(then.at_most) && std::isnan(now.at_most)))
            << in.family << ": " << now.text << " / " << then.text;
        ++answers;
      }
    }
  EXPECT_GT(answers, 50);
}

// What there is no solution of in rationals has none, whatever solves rows nearby: walls that overlap by a rounding.
TEST(Judge, ReferencesAreOfTheseRows) {
  for (const double overlap : {0x1p-45, 0x1p-52}) {
    const FoundReference found = reference_for(overlapping_walls(overlap), {});
    EXPECT_FALSE(found.reference && found.reference->feasible) << overlap;
  }
}

}  // namespace
}  // namespace zwang
