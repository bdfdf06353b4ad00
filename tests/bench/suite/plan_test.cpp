#include <gtest/gtest.h>

#include <algorithm>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/bench/suite/trace.h>
#include <zwang/core/files/problem_file.h>
#include "tests/bench/suite/test_solvers.h"

namespace zwang {
namespace {

TEST(Plan, SplitsSolversAndKeepsSettingsWithTheirSolver) {
  EXPECT_EQ(split_solvers("a,b:key=1,other=2,c,a,b:key=1,other=2"),
            (std::vector<std::string>{"a", "b:key=1,other=2", "c"}));
}

TEST(Plan, RunsToleranceFromLooseToTightOnce) {
  SuiteOptions options;
  options.scenes = scenes()[0].name;
  options.tolerances = {1e-10, 1e-2, 1e-10};
  const Plan p = make_plan(options, tests::all);
  ASSERT_EQ(p.runs.size(), 2 * tests::all.size());
  EXPECT_EQ(p.runs[0].tolerance, 1e-2);
  EXPECT_EQ(p.runs[1].tolerance, 1e-10);
  EXPECT_EQ(p.size(), p.runs.size());
}

TEST(Plan, NamesTheNearestWord) {
  SuiteOptions options;
  options.suite = "quik";
  try {
    make_plan(options, tests::all);
    FAIL() << "an unknown suite was accepted";
  } catch (const std::invalid_argument& wrong) {
    EXPECT_NE(std::string(wrong.what()).find("did you mean 'quick'?"), std::string::npos) << wrong.what();
  }
}

TEST(Plan, EverySuiteNamesScenesThatExist) {
  for (const Suite& suite : suites()) EXPECT_NO_THROW(make_scenes(suite.scenes)) << suite.name;
}

TEST(Plan, StatesEachProblemWithFrictionUnderEachLaw) {
  SuiteOptions options;
  options.scenes = "tower(boxes=2),ROD";
  options.laws = parse_laws("pyramid,convex,coulomb");
  const Plan p = make_plan(options, tests::all);
  ASSERT_EQ(p.instances.size(), 4u);
  const std::string unread = laws_not_read(p, tests::all);
  EXPECT_TRUE(unread.starts_with("Unsupported: ")) << unread;
  EXPECT_TRUE(unread.ends_with(
      " on 1 problem under the law convex and 1 problem under the law coulomb (expected frictionless or pyramid)"))
      << unread;
  const std::vector<std::string> names = {"tower(boxes=2)", "ROD (pyramid)", "ROD (convex)", "ROD"};
  const std::vector<Law> laws = {Law::frictionless, Law::pyramid, Law::convex, Law::coulomb};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(p.instances[i].problem.name, names[i]);
    EXPECT_EQ(p.instances[i].problem.law, laws[i]);
    EXPECT_EQ(p.coulomb.contains(i), i == 1 || i == 2);
    if (p.coulomb.contains(i)) {
      EXPECT_EQ(problem_sha256(p.coulomb.at(i).problem), problem_sha256(p.instances[3].problem));
    }
  }
  EXPECT_EQ(p.instances[2].family, "ROD (convex)");
  options.laws = parse_laws("convex");
  const Plan one = make_plan(options, tests::all);
  EXPECT_EQ(one.instances[1].problem.name, "ROD");
  EXPECT_EQ(one.instances[1].problem.law, Law::convex);
  for (const char* bad : {"", "cone", "convex,convex", "pyramid;convex"})
    EXPECT_THROW(parse_laws(bad), std::invalid_argument) << bad;
}

TEST(Plan, ProblemsOfOneNameAreToldApart) {
  SuiteOptions options;
  options.scenes = "tower(boxes=2),tower(boxes=2),ROD,tower(boxes=2)";
  std::vector<std::string> names;
  for (const Instance& i : make_plan(options, tests::all).instances) names.push_back(i.problem.name);
  EXPECT_EQ(names, (std::vector<std::string>{"tower(boxes=2)", "tower(boxes=2) (2)", "ROD", "tower(boxes=2) (3)"}));
}

TEST(Plan, AbsentSolversAreNamedInOneLine) {
  const std::vector<AbsentSolver> absent = {
      {"siconos_nsgs", "Siconos' numerics"}, {"siconos_admm", "Siconos' numerics"}, {"daqp", "DAQP 0.9"}};
  EXPECT_EQ(not_built_in(absent), "Not built in: siconos_nsgs, siconos_admm (Siconos' numerics), daqp (DAQP 0.9)");
  EXPECT_EQ(not_built_in({}), "");
}

TEST(Budget, IsSharedSoThatAllFit) {
  const std::vector<double> seconds = {1e-3, 0.1, 2};
  const std::vector<int> counts = share_budget(seconds, 1, 25);
  EXPECT_EQ(counts[0], 25);
  EXPECT_GE(counts[1], 5);
  EXPECT_EQ(counts[2], 0);
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += counts[i] * seconds[i];
  EXPECT_LE(sum, 1);
  for (const int count : share_budget(seconds, 0, 25)) EXPECT_EQ(count, 0);
}

TEST(Budget, QuartilesAreLinearBetweenSamples) {
  const Quartiles q = quartiles({4, 1, 3, 2, 5});
  EXPECT_EQ(q.q1, 2);
  EXPECT_EQ(q.median, 3);
  EXPECT_EQ(q.q3, 4);
  EXPECT_EQ(quartiles({7}).q1, 7);
  EXPECT_EQ(quartiles({1, 2}).median, 1.5);
}

TEST(Batch, RepeatsInterleavedAndGivesUpAfterATimeout) {
  const Instance instance = tests::chain(4);
  const std::vector<zwang::Run> runs = {{"all_active", false, 1e-4}, {"hangs", true, 1e-4}, {"hangs", true, 1e-10}};
  Dispatcher desk([](std::string_view text) { return make_solver(text, tests::all); });
  const auto timed = time_batch(instance.problem, runs, {.time_limit = 0.05, .budget = 0.1, .repetitions = 7}, desk,
                                tests::never, [](double, std::size_t) {});
  ASSERT_EQ(timed.size(), 3u);
  EXPECT_EQ(timed[0].samples.size(), 7u);
  EXPECT_GT(*std::min_element(timed[0].samples.begin(), timed[0].samples.end()), 0);
  EXPECT_EQ(timed[1].solution.status, Status::time_limit);
  EXPECT_TRUE(timed[1].samples.empty());
  EXPECT_EQ(timed[2].solution.message, "not run: met the time limit at tolerance 0.0001");
  EXPECT_EQ(timed[2].first_s, 0);
}

TEST(Progress, WritesTimesAndCountsForPeople) {
  EXPECT_EQ(duration(0.18), "180 ms");
  EXPECT_EQ(duration(59.7), "1 min 0 s");
  EXPECT_EQ(duration(560), "9 min 20 s");
  EXPECT_EQ(duration(7300), "2 h 1 min");
  EXPECT_EQ(grouped(3402), "3,402");
  EXPECT_EQ(grouped(12), "12");
  EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST(Trace, TakesIterationsOnALadder) {
  std::vector<int> rungs;
  for (int k = 0; k <= 100; ++k)
    if (is_rung(k)) rungs.push_back(k);
  EXPECT_EQ(rungs, (std::vector<int>{0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96}));
}

}  // namespace
}  // namespace zwang
