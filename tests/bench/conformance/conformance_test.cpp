#include <gtest/gtest.h>

#include <cmath>

#include <zwang/bench/conformance/conformance.h>
#include <zwang/bench/references/friction/coulomb.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/suite/phenomena.h>

#include "tests/bench/suite/test_solvers.h"

namespace zwang {
namespace {

// A ball that begins to roll is at the edge of its cone but for the rounding of its inertia, 2/5: there a solution of
// rows that are off by as much has to do.
Solution by_reference(const Problem& p) {
  Solution s;
  const std::vector<CoulombSolution> found = coulomb_solutions(p, {}, &s.message);
  const bool near = !found.empty() && found.front().delta <= 1e-16;
  s.status = near ? Status::solved : Status::numerical_failure;
  if (near) s.z = found.front().z;
  return s;
}

TEST(Conformance, TheReferenceMethodPassesEveryCheck) {
  for (const ConformanceCheck& check : conformance_checks()) {
    const ConformanceResult result = check.run(by_reference);
    EXPECT_TRUE(result.passes(1e-12)) << check.name << ": off by " << result.off << " " << result.note;
  }
}

// Every planar problem of the kit, in rationals: what the check expects is among the solutions.
TEST(Conformance, EnumerationInRationalsConfirmsThePlanarAnswers) {
  int confirmed = 0;
  for (const ConformanceCheck& check : conformance_checks()) {
    double off = 0;
    bool planar = true;
    const ConformanceResult nearest = check.run([&](const Problem& p) {
      Solution s;
      const std::optional<ExactSolutions> all = enumerate_planar(p);
      planar &= all.has_value();
      if (!all || all->solutions().empty()) return s;
      s.status = Status::solved;
      s.z = all->solutions()[0].z;
      return s;
    });
    if (!planar || std::isnan(nearest.off) || check.name == "PINCH") continue;
    off = nearest.off;
    EXPECT_LE(off, 1e-14) << check.name;
    ++confirmed;
  }
  EXPECT_GE(confirmed, 9);
}

TEST(Conformance, SaysByHowMuchAnAnswerIsOffAndWhatASolverSaid) {
  const auto still = [](const Problem& p) {
    Solution s;
    s.status = Status::solved;
    s.z = Vector::Zero(p.size());
    return s;
  };
  const auto mute = [](const Problem&) {
    Solution s;
    s.message = "gave up";
    return s;
  };
  for (const ConformanceCheck& check : conformance_checks()) {
    if (check.name == "box slides") {
      EXPECT_EQ(check.run(still).off, 3);
      EXPECT_FALSE(check.run(still).passes(1e-6));
      EXPECT_TRUE(std::isnan(check.run(mute).off));
      EXPECT_NE(check.run(mute).note.find("gave up"), std::string::npos);
      EXPECT_FALSE(check.run(mute).passes(1e9));
    }
    if (check.name == "box rests") {
      EXPECT_TRUE(check.run(still).passes(0));
    }
  }
}

TEST(Conformance, ASolverIsJudgedUnderTheNearestLawThatItReads) {
  const auto reads_pyramid = [](const Problem& p) {
    Solution s;
    s.status = p.has_tangents() ? Status::unsupported : Status::solved;
    s.message = "no tangent rows";
    s.z = Vector::Zero(p.size());
    return s;
  };
  Law law = Law::coulomb;
  const ConformanceSolve solve = conformance_solve(reads_pyramid, &law);
  const ConformanceSolve refuse = conformance_solve([](const Problem&) {
    Solution s;
    s.status = Status::unsupported;
    return s;
  });
  for (const ConformanceCheck& check : conformance_checks()) {
    EXPECT_TRUE(check.run(solve).applies) << check.name;
    EXPECT_FALSE(check.run(refuse).applies) << check.name;
    EXPECT_FALSE(check.run(refuse).passes(1e9)) << check.name;
  }
  EXPECT_EQ(law, Law::pyramid);
}

// Once its time is over a solver is stopped, and what comes after is answered at once.
TEST(Conformance, ASolverThatNeverEndsIsStoppedAndSaidToHaveNoAnswer) {
  Dispatcher desk([](std::string_view) { return AnySolver(tests::Hangs{}); });
  const zwang::Run run{.solver = "hangs", .foreign = true};
  SolveTime time{.left = 0.05};
  const ConformanceSolve solve = conformance_solve(run, desk, time);
  for (const ConformanceCheck& check : conformance_checks()) {
    const ConformanceResult result = check.run(solve);
    if (check.name == "JAM beyond") continue;  // where no answer is right
    EXPECT_TRUE(std::isnan(result.off)) << check.name;
    EXPECT_EQ(result.note.find("time limit: stopped"), 0u) << check.name << ": " << result.note;
  }
  EXPECT_LE(time.left, 0);
  EXPECT_GE(time.left, -0.5);
}

}  // namespace
}  // namespace zwang
