#include <zwang/bench/suite/suite.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <zwang/bench/results/seal.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/run_record.h>
#include <zwang/bench/timing/instruction_set.h>
#include "tests/bench/suite/test_solvers.h"
#include "tests/folders.h"

namespace zwang {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Folder {
  fs::path path;
  explicit Folder(const std::string& name) : path(own_path(name)) { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
};

Plan plan(const std::string& solvers, std::vector<double> tolerances = {1e-4, 1e-10}) {
  Plan p;
  p.options.suite = "quick";
  p.options.solvers = solvers;
  p.options.tolerances = std::move(tolerances);
  p.time_limit = 0.05;
  for (const std::string& text : split_solvers(solvers))
    for (const double t : p.options.tolerances) p.runs.push_back({text, find_solver(text, tests::all)->foreign, t});
  for (const Index n : {3, 5, 8}) p.instances.push_back(tests::chain(n));
  return p;
}

SuiteSettings in(const fs::path& directory) {
  SuiteSettings s;
  s.directory = directory;
  s.command = "test";
  s.solvers = tests::all;
  return s;
}

std::vector<std::string> texts_of(const fs::path& file) {
  std::vector<std::string> all;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}
std::vector<Json> lines_of(const fs::path& file) {
  std::vector<Json> all;
  for (const std::string& line : texts_of(file)) all.push_back(Json::parse(line));
  return all;
}

// The columns of results.jsonl.
std::vector<std::string> columns() {
  std::vector<std::string> keys;
  const Result any;
  Result::columns(any, Columns{[&](const std::string& key, const auto&, const Column&) { keys.push_back(key); }});
  return keys;
}
// Of problems with friction; where an accuracy is asked for.
const std::set<std::string> not_always = {"penetration", "cone_violation", "dissipation", "eta",      "self_bound",
                                          "radius",      "delta",          "null_motion", "isolated", "coulomb_error",
                                          "accuracy",    "error_bound",    "promise"};

std::vector<std::string> sorted(std::vector<std::string> words) {
  std::ranges::sort(words);
  return words;
}

// `a`, `b` -> a | b.
std::vector<std::string> quoted_in(const std::string& text, char mark = '`') {
  std::vector<std::string> words;
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; ++at) {
    const std::size_t end = text.find(mark, at + 1);
    words.push_back(text.substr(at + 1, end - at - 1));
    at = end;
  }
  return words;
}

TEST(Docs, NameEachColumnOfResults) {
  std::ifstream file(source_dir() / "docs/formats.md");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = text.substr(text.find("### results.jsonl"));
  std::vector<std::string> named;
  std::istringstream rows(text.substr(0, text.find("\n### ", 1)));
  for (std::string row; std::getline(rows, row);)
    if (row.starts_with("| `"))
      for (const std::string& key : quoted_in(row.substr(0, row.find('|', 1)))) named.push_back(key);
  std::vector<std::string> written = columns();
  written.push_back("check");
  EXPECT_EQ(sorted(named), sorted(written));

  const std::size_t list = text.find("These columns depend on the clock");
  std::ifstream script(source_dir() / "bench/campaign/merge.py");
  std::string merge{std::istreambuf_iterator<char>(script), {}};
  merge = merge.substr(merge.find("\nCLOCK = {"));
  const std::vector<std::string> of_clock = quoted_in(merge.substr(0, merge.find('}')), '"');
  for (const std::string& key : of_clock) EXPECT_EQ(std::ranges::count(written, key), 1) << key;
  EXPECT_EQ(sorted(quoted_in(text.substr(list, text.find("All others", list) - list))), sorted(of_clock));
}

// An answer at 1e-3 of the motion from the truth.
TEST(Suite, ABrokenPromiseIsAFalseClaim) {
  Instance instance = make_scenes("WEAK")[0];
  Solution s = make_solver("dual_active_set").solve(instance.problem);
  instance.reference = Reference{.z = s.z, .lambda = s.lambda, .method = "known answer"};
  const Problem& p = instance.problem;
  const Vector aside = Vector::Unit(p.size(), 0);
  const auto length = [&](const Vector& z) { return std::sqrt(z.dot(p.M * z)); };
  s.z += 1e-3 * std::max(length(p.z_u), length(s.z)) / length(aside) * aside;
  for (const double promised : {1e-2, 1e-5}) {
    Result r;
    r.tolerance = 1e-10;
    s.error_bound = promised;
    judge(r, instance, s);
    EXPECT_EQ(r.promise, promised > 1e-3 ? "kept" : "broken");
    EXPECT_EQ(r.lies(), r.promise == "broken");
  }
}

TEST(Suite, WritesEveryKeyOfTheContract) {
  const Folder folder("keys");
  const Outcome outcome = run_suite(plan("all_active,lies,aborts"), in(folder.path), tests::never);
  EXPECT_EQ(outcome.tally.runs, 18u);
  EXPECT_EQ(outcome.tally.solved, 6u);
  EXPECT_EQ(outcome.tally.near, 0u);
  EXPECT_EQ(outcome.tally.lies, 6u);  // z_u is 0.2 off: nothing is near beyond a hundredth of the motion
  EXPECT_EQ(outcome.tally.failed, 6u);
  const auto lines = lines_of(folder.path / "results.jsonl");
  ASSERT_EQ(lines.size(), 18u);
  for (const Json& line : lines) {
    for (const std::string& key : columns()) EXPECT_EQ(line.contains(key), !not_always.contains(key)) << key;
    EXPECT_EQ(line.items().begin().key(), "problem");
    EXPECT_EQ(line.size(), columns().size() - not_always.size() + 1);  // and the check
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
  run_suite(plan("all_active,lies"), in(a.path), tests::never);
  run_suite(plan("all_active,lies"), in(b.path), tests::never);
  auto first = lines_of(a.path / "results.jsonl"), second = lines_of(b.path / "results.jsonl");
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (const char* time :
         {"setup_s", "kernel_s", "solve_s", "solve_s_q1", "solve_s_q3", "prepare_s", "repetitions", "check"}) {
      first[i].erase(time);
      second[i].erase(time);
    }
    EXPECT_EQ(first[i], second[i]);
  }
}

TEST(Suite, TellsAfterEachProblemThatItsResultsStand) {
  const Folder folder("early");
  SuiteSettings settings = in(folder.path);
  std::size_t times = 0;
  settings.between = [&] { EXPECT_EQ(lines_of(folder.path / "results.jsonl").size(), 4 * ++times); };
  run_suite(plan("all_active,lies"), settings, tests::never);
  EXPECT_EQ(times, 3u) << "once a problem";
}

TEST(Suite, TracesOneProblemOfAFamily) {
  const Folder folder("trace");
  run_suite(plan("all_active"), in(folder.path), tests::never);
  const auto points = lines_of(folder.path / "traces.jsonl");
  ASSERT_EQ(points.size(), 5u);
  for (const Json& p : points) EXPECT_EQ(p["problem"], "chain(n=5)") << "the middle one";
  EXPECT_GT(points[0]["z_error"].get<double>(), 0.5);
  EXPECT_EQ(points[4]["iteration"], 5);
  EXPECT_LT(points[4]["z_error"].get<double>(), 1e-14);
}

TEST(Resume, DropsATornLineAndMakesOnlyWhatIsMissing) {
  const Folder folder("resume");
  const Plan p = plan("all_active,lies");
  run_suite(p, in(folder.path), tests::never);
  const auto file = folder.path / "results.jsonl";
  const auto before = lines_of(file);

  // What a killed run leaves: seven lines and a half.
  {
    std::ofstream out(file, std::ios::trunc);
    for (std::size_t i = 0; i < 7; ++i) out << before[i].dump() << '\n';
    out << before[7].dump().substr(0, 90);
  }
  const Outcome outcome = run_suite(p, in(folder.path), tests::never);
  EXPECT_EQ(outcome.tally.runs, 12u);
  const auto after = lines_of(file);
  ASSERT_EQ(after.size(), 12u);
  std::set<std::string> names;
  for (const Json& line : after) names.insert(line["cell"]);
  EXPECT_EQ(names.size(), 12u) << "a line is there twice";
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(after[i], before[i]) << "a finished line was touched";
}

// Three problems with an answer each: 0.2 off, exact, and exact.
Plan with_recorded_answers() {
  Plan p = plan("all_active,lies");
  Solution exact;
  for (Instance& instance : p.instances) {
    tests::AllActive().solve(instance.problem, {}, exact);
    instance.recorded = {{"somebody", &instance == &p.instances.front() ? instance.problem.z_u : exact.z}};
  }
  return p;
}

TEST(Recorded, AnswersAreJudgedAndCountInNoTally) {
  const Folder folder("recorded");
  const Outcome outcome = run_suite(with_recorded_answers(), in(folder.path), tests::never);
  EXPECT_EQ(outcome.planned, 12u);
  EXPECT_EQ(outcome.tally.runs, 12u);
  EXPECT_EQ(outcome.tally.recorded, 3u);
  std::vector<std::string> verdicts;
  for (const Json& line : lines_of(folder.path / "results.jsonl"))
    if (line["solver"] == "recorded:somebody") {
      verdicts.push_back(line["verified"]);
      EXPECT_EQ(line["claimed"], "unsolved");
      EXPECT_EQ(line["tolerance"], 1e-10);
      EXPECT_TRUE(line["solve_s"].is_null());
      EXPECT_EQ(line["z_error"].get<double>() > 0.01, verdicts.size() == 1);
    }
  EXPECT_EQ(verdicts, (std::vector<std::string>{"wrong", "solved", "solved"}));
}

TEST(Recorded, AnswersStandOnceAfterAResumeWhereverTheRunWasKilled) {
  const Folder folder("recorded-resume");
  const Plan p = with_recorded_answers();
  run_suite(p, in(folder.path), tests::never);
  const auto file = folder.path / "results.jsonl";
  const auto whole = texts_of(file);
  ASSERT_EQ(whole.size(), 15u);
  for (std::size_t kept = 0; kept < whole.size(); ++kept) {
    {
      std::ofstream out(file, std::ios::trunc);
      for (std::size_t i = 0; i < kept; ++i) out << whole[i] << '\n';
      out << whole[kept].substr(0, 90);
    }
    const Outcome outcome = run_suite(p, in(folder.path), tests::never);
    EXPECT_EQ(outcome.tally.runs, 12u);
    EXPECT_EQ(outcome.tally.recorded, 3u);
    EXPECT_EQ(lines_of(file).size(), 15u) << "killed in line " << kept + 1;
  }
}

TEST(Resume, GoesOnWithTheProblemsThatAProgramGave) {
  const Folder folder("given");
  Plan p = plan("all_active");
  p.options.given = p.instances.size();
  const std::atomic<bool> at_once = true;
  run_suite(p, in(folder.path), at_once);
  const SuiteOptions stored = options_to_resume(folder.path, {}, [](const std::string&) { return false; });
  ASSERT_EQ(stored.instances.size(), 3u);
  const Plan again = make_plan(stored, tests::all);
  EXPECT_EQ(again.title(), "your problems");
  EXPECT_EQ(run_suite(again, in(folder.path), tests::never).tally.runs, 6u);
}

TEST(Sequence, TimesEachFrameColdAndFromTheAnswerBefore) {
  const Folder folder("sequence");
  Plan p = plan("all_active");
  p.options.sequence = true;
  p.instances = {tests::chain(4), tests::chain(4), tests::chain(4)};
  run_suite(p, in(folder.path), tests::never);
  const auto lines = lines_of(folder.path / "speed.jsonl");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["kind"], "sequence");
  EXPECT_EQ(lines[0]["sequence"], p.instances[0].family);
  for (const char* start : {"cold", "warm"}) {
    EXPECT_EQ(lines[0][start]["frames"], 3);
    EXPECT_EQ(lines[0][start]["right"], 1);
  }
}

TEST(Resume, MakesADamagedLineAgain) {
  const Folder folder("damaged");
  const Plan p = plan("all_active,lies");
  run_suite(p, in(folder.path), tests::never);
  const auto file = folder.path / "results.jsonl";
  std::vector<std::string> lines;
  {
    std::ifstream stored(file);
    for (std::string line; std::getline(stored, line);) lines.push_back(line);
  }
  ASSERT_EQ(lines.size(), 12u);
  // Every byte of a line is under its check: each of these is found, whichever key it is in.
  for (std::size_t at = 0; at < lines[5].size(); at += 7) {
    std::string damaged = lines[5];
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_FALSE(is_intact(damaged)) << at;
  }
  std::string& hit = lines[5];
  hit[hit.find("\"z_error\":") + 10] ^= 1;
  {
    std::ofstream out(file, std::ios::trunc);
    for (const std::string& line : lines) out << line << '\n';
  }
  const Stored stored = load_results(file);
  EXPECT_EQ(stored.damaged, 1u);
  EXPECT_EQ(stored.finished.size(), 11u);
  const Outcome outcome = run_suite(p, in(folder.path), tests::never);
  EXPECT_EQ(outcome.earlier, 11u);
  EXPECT_EQ(outcome.tally.runs, 12u);
  EXPECT_EQ(load_results(file).finished.size(), 12u);
}

TEST(Suite, TwoRunsDoNotWriteIntoOneFolder) {
  const Folder folder("two");
  SuiteSettings settings = in(folder.path);
  int tried = 0;
  settings.between = [&] {
    if (tried++ > 0) return;
    EXPECT_THROW(run_suite(plan("all_active,lies"), in(folder.path), tests::never), std::invalid_argument);
  };
  EXPECT_EQ(run_suite(plan("all_active,lies"), settings, tests::never).tally.runs, 12u);
  EXPECT_GT(tried, 0);
  EXPECT_EQ(run_suite(plan("all_active,lies"), in(folder.path), tests::never).earlier, 12u);
}

TEST(Shard, PartsTogetherAreTheSuite) {
  const Folder whole("whole");
  run_suite(plan("all_active,lies"), in(whole.path), tests::never);
  const Stored all = load_results(whole.path / "results.jsonl");
  std::set<std::string> cells;
  for (const char* text : {"0/2", "1/2"}) {
    const Folder part("part");
    Plan p = plan("all_active,lies");
    p.options.shard = text;
    p.shard = read_shard(text);
    EXPECT_EQ(run_suite(p, in(part.path), tests::never).tally.runs, p.size());
    const Stored stored = load_results(part.path / "results.jsonl");
    EXPECT_EQ(stored.finished.size(), p.size());
    cells.insert(stored.finished.begin(), stored.finished.end());
  }
  EXPECT_EQ(cells, all.finished);
  for (const char* wrong : {"1", "2/2", "-1/2", "0/0", "0/2x", "a/b"})
    EXPECT_THROW(read_shard(wrong), std::invalid_argument) << wrong;
}

TEST(Resume, RefusesAnotherProblemAndOtherOptions) {
  const Folder folder("refuse");
  run_suite(plan("all_active"), in(folder.path), tests::never);
  Plan other = plan("all_active");
  other.instances[1].problem.c[0] = 1;
  EXPECT_THROW(run_suite(other, in(folder.path), tests::never), BadFile);

  SuiteOptions typed;
  typed.suite = "full";
  const auto none = [](const std::string&) { return false; };
  EXPECT_THROW(options_to_resume(folder.path, typed, [](const std::string& name) { return name == "suite"; }),
               std::invalid_argument);
  EXPECT_EQ(options_to_resume(folder.path, typed, none).suite, "quick");
  EXPECT_THROW(options_to_resume(folder.path / "nowhere", typed, none), BadFile);
}

TEST(Resume, RefusesAnotherCommit) {
  const Folder folder("commit");
  run_suite(plan("all_active"), in(folder.path), tests::never);
  std::ifstream file(folder.path / "run.json");
  Json run = Json::parse(file);
  run["commit"] = "another";
  std::ofstream(folder.path / "run.json") << run;
  try {
    options_to_resume(folder.path, {}, [](const std::string&) { return false; });
    FAIL() << "another commit was accepted";
  } catch (const BadFile& wrong) {
    EXPECT_NE(std::string(wrong.what()).find("its commit is \"another\""), std::string::npos) << wrong.what();
  }
}

TEST(InstructionSet, NamesWhatACpuLacks) {
  EXPECT_EQ(lacking(avx2 | fma | avx512f, avx | avx2), "FMA, AVX-512F");
  EXPECT_EQ(lacking(built_for, built_for), "");
  EXPECT_EQ(lacking(0, 0), "");
}

TEST(Suite, LosesNothingWhenInterrupted) {
  const Folder folder("interrupt");
  const std::atomic<bool> at_once = true;
  const Outcome stopped = run_suite(plan("all_active"), in(folder.path), at_once);
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_EQ(stopped.tally.runs, 0u);
  EXPECT_EQ(stopped.planned, 6u);
  EXPECT_TRUE(read_run_record(folder.path).finished.empty());
  EXPECT_EQ(run_suite(plan("all_active"), in(folder.path), tests::never).tally.runs, 6u);
  EXPECT_FALSE(read_run_record(folder.path).finished.empty());
}

TEST(Result, WorstRowOfEachTypeInItsOwnUnit) {
  Matrix J(3, 2);
  J << 2, 0, 0, 1, 0, 4;
  Problem p{.name = "test", .z_u = Vector::Zero(2), .J = J.sparseView(), .c = Vec3(3, 1, 8)};
  p.M = Matrix::Identity(2, 2).sparseView();
  p.kind.assign(3, RowKind::inequality);
  p.key.resize(3);
  const Instance instance{.problem = p, .origin = {{"limit", "x"}, {"contact", "y"}, {"contact", "z"}}};
  const std::vector<WorstRow> worst = worst_by_type(instance, Vec<double, 2>(1, 0.5));
  ASSERT_EQ(worst.size(), 2u);
  EXPECT_EQ(worst[0].type, "contact");
  EXPECT_EQ(worst[0].name, "contact/z");
  EXPECT_DOUBLE_EQ(worst[0].violation, 6);
  EXPECT_DOUBLE_EQ(worst[0].relative, 1.5 / std::hypot(1, 0.5));
  EXPECT_EQ(worst[1].type, "limit");
  EXPECT_DOUBLE_EQ(worst[1].violation, 1);
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

TEST(Result, IsReadBackAsItWasWritten) {
  Result r;
  r.problem = "p \"1\"";
  r.seed = std::numeric_limits<std::uint64_t>::max();
  r.law = "coulomb";
  r.feasible = true;
  r.solver = "cone";
  r.tolerance = 1e-10;
  r.claimed = Status::solved_ill_conditioned;
  r.metrics.verdict = Verdict::rows_off;
  r.metrics.z_bound = 0.1;
  r.metrics.friction.isolated = true;
  r.worst_by_type = {{"contact", 0x1p-40, unknown, "contact 3", "m/s^2"}};
  r.conflicting = {"a", "b"};
  r.margins.rank = 2;
  r.machine = "a CPU";
  r.cell = "0123";
  for (const std::string& line : {to_json(r), to_json(Result{.solver = "nnls"})})
    EXPECT_EQ(to_json(read_result(line)), line);
}

TEST(Result, CountsALineThatIsNoneAsDamaged) {
  const Folder folder("bad");
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "results.jsonl") << "{\"solver\":\"a\"}\n";
  EXPECT_EQ(load_results(folder.path / "results.jsonl").damaged, 1u);
}

}  // namespace
}  // namespace zwang
