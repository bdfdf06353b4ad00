#include "bench/suite/suite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/scenes/catalog.h"
#include "bench/suite/progress.h"
#include "bench/suite/run_record.h"
#include "bench/suite/trace.h"
#include "tests/suite/test_solvers.h"

namespace zwang {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<SolverEntry> solvers_here = {tests::entry<tests::AllActive>(false), tests::entry<tests::Lies>(false),
                                               tests::entry<tests::Aborts>(true), tests::entry<tests::Hangs>(true)};

struct Folder {
  fs::path path;
  explicit Folder(const std::string& name)
      : path(fs::temp_directory_path() / ("zwang-" + name + std::to_string(getpid()))) {
    fs::remove_all(path);
  }
  ~Folder() { fs::remove_all(path); }
};

Plan plan(const std::string& solvers, std::vector<double> tolerances = {1e-4, 1e-10}) {
  Plan p;
  p.options.suite = "quick";
  p.options.solvers = solvers;
  p.options.tolerances = std::move(tolerances);
  p.time_limit = 0.05;
  for (const std::string& text : split_solvers(solvers))
    for (const double t : p.options.tolerances) p.runs.push_back({text, find_solver(text, solvers_here)->foreign, t});
  for (const Index n : {3, 5, 8}) p.instances.push_back(tests::chain(n));
  return p;
}

SuiteSettings in(const fs::path& directory) {
  SuiteSettings s;
  s.directory = directory;
  s.command = "test";
  s.solvers = solvers_here;
  return s;
}

std::vector<Json> lines_of(const fs::path& file) {
  std::vector<Json> all;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) all.push_back(Json::parse(line));
  return all;
}

const std::atomic<bool> never = false;

TEST(Plan, SplitsSolversAndKeepsSettingsWithTheirSolver) {
  EXPECT_EQ(split_solvers("a,b:key=1,other=2,c"), (std::vector<std::string>{"a", "b:key=1,other=2", "c"}));
}

TEST(Plan, RunsToleranceFromLooseToTightOnce) {
  SuiteOptions options;
  options.scenes = scenes()[0].name;
  options.tolerances = {1e-10, 1e-2, 1e-10};
  const Plan p = make_plan(options, solvers_here);
  ASSERT_EQ(p.runs.size(), 2 * solvers_here.size());
  EXPECT_EQ(p.runs[0].tolerance, 1e-2);
  EXPECT_EQ(p.runs[1].tolerance, 1e-10);
  EXPECT_EQ(p.size(), p.runs.size());
}

TEST(Plan, NamesTheNearestWord) {
  SuiteOptions options;
  options.suite = "quik";
  try {
    make_plan(options, solvers_here);
    FAIL() << "an unknown suite was accepted";
  } catch (const std::invalid_argument& wrong) {
    EXPECT_NE(std::string(wrong.what()).find("did you mean 'quick'?"), std::string::npos) << wrong.what();
  }
}

TEST(Plan, EverySuiteNamesScenesThatExist) {
  for (const Suite& suite : suites()) EXPECT_NO_THROW(make_scenes(suite.scenes)) << suite.name;
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
  Desk desk([](std::string_view text) { return make_solver(text, solvers_here); });
  const auto timed = time_batch(instance.problem, runs, {.time_limit = 0.05, .budget = 0.1, .repetitions = 7}, desk,
                                never, [](double, std::size_t) {});
  ASSERT_EQ(timed.size(), 3u);
  EXPECT_EQ(timed[0].samples.size(), 7u);
  EXPECT_GT(*std::min_element(timed[0].samples.begin(), timed[0].samples.end()), 0);
  EXPECT_EQ(timed[1].solution.status, Status::time_limit);
  EXPECT_TRUE(timed[1].samples.empty());
  EXPECT_EQ(timed[2].solution.message, "not run: met the time limit at tolerance 1e-04");
  EXPECT_EQ(timed[2].first_s, 0);
}

TEST(Suite, WritesEveryKeyOfTheContract) {
  const Folder folder("keys");
  const Outcome outcome = run_suite(plan("all_active,lies,aborts"), in(folder.path), never);
  EXPECT_EQ(outcome.tally.runs, 18u);
  EXPECT_EQ(outcome.tally.solved, 6u);
  EXPECT_EQ(outcome.tally.near, 3u);  // z_u is 0.2 off, within 1000 times 10 times 1e-4
  EXPECT_EQ(outcome.tally.lies, 3u);
  EXPECT_EQ(outcome.tally.failed, 6u);
  const auto lines = lines_of(folder.path / "results.jsonl");
  ASSERT_EQ(lines.size(), 18u);
  const std::vector<std::string> keys = {"problem",
                                         "family",
                                         "knob",
                                         "knob_value",
                                         "n",
                                         "m",
                                         "equalities",
                                         "seed",
                                         "problem_sha256",
                                         "problem_file",
                                         "solver",
                                         "foreign",
                                         "tolerance",
                                         "claimed",
                                         "verified",
                                         "z_error",
                                         "z_bound",
                                         "bound_method",
                                         "bound_sigma_min",
                                         "primal",
                                         "dual",
                                         "stationarity",
                                         "complementarity",
                                         "gap",
                                         "natural",
                                         "scale",
                                         "farkas",
                                         "setup_s",
                                         "solve_s",
                                         "solve_s_q1",
                                         "solve_s_q3",
                                         "kernel_s",
                                         "allocations",
                                         "repetitions",
                                         "iterations",
                                         "reference",
                                         "reference_bound",
                                         "feasible",
                                         "worst_row",
                                         "worst_by_type",
                                         "rank",
                                         "smallest_pivot",
                                         "largest_rejected_pivot",
                                         "redundant",
                                         "conflicting",
                                         "fallback",
                                         "range_gap",
                                         "message",
                                         "batch"};
  for (const Json& line : lines) {
    for (const std::string& key : keys) EXPECT_TRUE(line.contains(key)) << key;
    EXPECT_EQ(line.size(), keys.size());
    EXPECT_TRUE(fs::exists(folder.path / line.at("problem_file").get<std::string>()));
    if (line["solver"] == "all_active") {
      EXPECT_LE(line["z_error"].get<double>(), 1e-14);
      EXPECT_GT(line["solve_s"].get<double>(), 0);
      EXPECT_LE(line["solve_s_q1"].get<double>(), line["solve_s_q3"].get<double>());
      EXPECT_GE(line["setup_s"].get<double>(), 0);
      EXPECT_GT(line["repetitions"].get<int>(), 1);
    }
    if (line["solver"] == "aborts") {
      EXPECT_EQ(line["claimed"], "crashed");
      EXPECT_TRUE(line["z_error"].is_null());
    }
  }
  std::ifstream file(folder.path / "run.json");
  const Json run = Json::parse(file);
  for (const char* key :
       {"zwang", "suite", "command", "started", "finished", "seed", "commit", "dirty", "compiler", "flags",
        "build_type", "cpu", "cores", "libraries", "tolerances", "solvers", "problems", "notes"})
    EXPECT_TRUE(run.contains(key)) << key;
  EXPECT_TRUE(run["finished"].is_string());
  EXPECT_EQ(run["problems"], 3);
  EXPECT_TRUE(run["libraries"].contains("Eigen"));
}

TEST(Suite, GivesTheSameResultsTwiceButForTimes) {
  const Folder a("same-a"), b("same-b");
  run_suite(plan("all_active,lies"), in(a.path), never);
  run_suite(plan("all_active,lies"), in(b.path), never);
  auto first = lines_of(a.path / "results.jsonl"), second = lines_of(b.path / "results.jsonl");
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (const char* time : {"setup_s", "kernel_s", "solve_s", "solve_s_q1", "solve_s_q3", "repetitions"}) {
      first[i].erase(time);
      second[i].erase(time);
    }
    EXPECT_EQ(first[i], second[i]);
  }
}

TEST(Suite, TracesOneProblemOfAFamily) {
  const Folder folder("trace");
  run_suite(plan("all_active"), in(folder.path), never);
  const auto points = lines_of(folder.path / "traces.jsonl");
  ASSERT_EQ(points.size(), 5u);
  for (const Json& p : points) EXPECT_EQ(p["problem"], "chain(n=3)");
  EXPECT_GT(points[0]["z_error"].get<double>(), 0.5);
  EXPECT_EQ(points[4]["iteration"], 5);
  EXPECT_LT(points[4]["z_error"].get<double>(), 1e-14);
}

TEST(Resume, DropsATornLineAndMakesOnlyWhatIsMissing) {
  const Folder folder("resume");
  const Plan p = plan("all_active,lies");
  run_suite(p, in(folder.path), never);
  const auto file = folder.path / "results.jsonl";
  const auto before = lines_of(file);

  // What a killed run leaves: seven lines and a half.
  {
    std::ofstream out(file, std::ios::trunc);
    for (std::size_t i = 0; i < 7; ++i) out << before[i].dump() << '\n';
    out << before[7].dump().substr(0, 90);
  }
  const Outcome outcome = run_suite(p, in(folder.path), never);
  EXPECT_EQ(outcome.tally.runs, 12u);
  const auto after = lines_of(file);
  ASSERT_EQ(after.size(), 12u);
  std::set<RunName> names;
  for (const Json& line : after) names.emplace(line["problem_file"], line["solver"], line["tolerance"]);
  EXPECT_EQ(names.size(), 12u) << "a line is there twice";
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(after[i], before[i]) << "a finished line was touched";
}

TEST(Resume, RefusesAnotherProblemAndOtherOptions) {
  const Folder folder("refuse");
  run_suite(plan("all_active"), in(folder.path), never);
  Plan other = plan("all_active");
  other.instances[1].problem.c[0] = 1;
  EXPECT_THROW(run_suite(other, in(folder.path), never), std::invalid_argument);

  SuiteOptions typed;
  typed.suite = "full";
  EXPECT_THROW(options_to_resume(folder.path, typed, {"suite"}), std::invalid_argument);
  EXPECT_EQ(options_to_resume(folder.path, typed, {}).suite, "quick");
  EXPECT_THROW(options_to_resume(folder.path / "nowhere", typed, {}), BadFile);
}

TEST(Resume, RefusesAnotherCommit) {
  const Folder folder("commit");
  run_suite(plan("all_active"), in(folder.path), never);
  std::ifstream file(folder.path / "run.json");
  Json run = Json::parse(file);
  run["commit"] = "another";
  std::ofstream(folder.path / "run.json") << run;
  try {
    options_to_resume(folder.path, {}, {});
    FAIL() << "another commit was accepted";
  } catch (const std::invalid_argument& wrong) {
    EXPECT_NE(std::string(wrong.what()).find("its commit is \"another\""), std::string::npos) << wrong.what();
  }
}

TEST(Suite, LosesNothingWhenInterrupted) {
  const Folder folder("interrupt");
  const std::atomic<bool> at_once = true;
  const Outcome stopped = run_suite(plan("all_active"), in(folder.path), at_once);
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_EQ(stopped.tally.runs, 0u);
  EXPECT_EQ(stopped.planned, 6u);
  EXPECT_TRUE(read_run_record(folder.path).finished.empty());
  EXPECT_EQ(run_suite(plan("all_active"), in(folder.path), never).tally.runs, 6u);
  EXPECT_FALSE(read_run_record(folder.path).finished.empty());
}

TEST(Result, WritesNumbersThatJsonCannotHold) {
  Result r;
  r.knob_value = -std::numeric_limits<double>::infinity();
  r.metrics.farkas = std::numeric_limits<double>::infinity();
  const Json line = Json::parse(to_json(r));
  EXPECT_TRUE(line["z_error"].is_null());
  EXPECT_EQ(line["farkas"], std::numeric_limits<double>::max());
  EXPECT_EQ(line["knob_value"], std::numeric_limits<double>::lowest());
}

TEST(Result, RefusesALineThatIsNone) {
  const Folder folder("bad");
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "results.jsonl") << "{\"solver\":\"a\"}\n";
  EXPECT_THROW(load_results(folder.path / "results.jsonl"), BadFile);
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
