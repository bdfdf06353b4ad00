#include <zwang/bench/report/results.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <stdexcept>

#include <zwang/bench/report/wording.h>
#include "tests/folders.h"

namespace zwang::report {
namespace {

namespace fs = std::filesystem;

// A run folder that holds the given text as results.jsonl.
fs::path folder(const std::string& results) {
  const fs::path dir = own_path("results") / testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::create_directories(dir);
  std::ofstream(dir / "results.jsonl") << results;
  return dir;
}

const std::string line =
    R"({"problem":"p","family":"f","problem_file":"problems/0.h5","solver":"nnls","tolerance":1e-8,"claimed":"solved","verified":"wrong","z_error":null,"solve_s":2e-5})";

TEST(Results, ReadsNullAsUnknownAndBuildsTheReplayCommand) {
  const fs::path dir = folder(line + "\n");
  const RunFolder run = read_run(dir);
  ASSERT_EQ(run.results.size(), 1u);
  EXPECT_TRUE(std::isnan(run.results[0].metrics.z_error));
  EXPECT_EQ(run.results[0].solve_s, 2e-5);
  EXPECT_EQ(run.results[0].replay,
            "./zwang solve " + (dir / "problems/0.h5").generic_string() + " --solver nnls --tolerance 1e-8");
  ASSERT_EQ(run.solvers.size(), 1u);
  EXPECT_EQ(run.solvers[0].name, "nnls");
}

TEST(Results, AnAnswerCountsForTheSolverThatGaveItOnce) {
  const auto by = [](const char* problem, const char* solver, const char* handed_to, const char* time,
                     const char* verified = "solved") {
    return std::string(R"({"problem":")") + problem + R"(","solver":")" + solver + R"(","handed_to":")" + handed_to +
           R"(","tolerance":1e-8,"claimed":"solved","verified":")" + verified + R"(","z_error":0,"solve_s":)" + time +
           "}\n";
  };
  const RunFolder run = read_run(folder(by("p", "cone", "dual_active_set", "1") + by("p", "dual_active_set", "", "2") +
                                        by("q", "cone", "newton", "3") + by("q", "fixed_point", "newton", "4") +
                                        by("r", "cone", "", "5") + by("p", "nsgs", "dual_active_set", "6", "wrong")));
  ASSERT_EQ(run.results.size(), 4u);
  EXPECT_EQ(run.results[0].solver, "dual_active_set");
  EXPECT_EQ(run.results[0].solve_s, 2);  // its own run
  EXPECT_EQ(run.results[1].solver, "newton");
  EXPECT_EQ(run.results[1].solve_s, 3);
  EXPECT_NE(run.results[1].replay.find("--solver cone"), std::string::npos);
  EXPECT_EQ(run.results[2].solver, "cone");
  EXPECT_TRUE(run.results[3].lies());  // though another run of its solver on p is right
  EXPECT_EQ(run.results[3].solver, "dual_active_set");
  EXPECT_EQ(run.handed_over.at({"cone", "newton"}), std::set<std::string>{"q"});
  EXPECT_EQ(run.handed_over.at({"cone", "dual_active_set"}), std::set<std::string>{"p"});
  EXPECT_EQ(run.solvers.size(), 3u);
}

TEST(Results, LeavesOutATornLastLineAndSaysSo) {
  const RunFolder run = read_run(folder(line + "\n" + line.substr(0, 40)));
  EXPECT_EQ(run.results.size(), 1u);
  EXPECT_NE(run.torn.find("results.jsonl"), std::string::npos);
}

TEST(Results, NamesFileAndLineOfABadLineInTheMiddle) {
  try {
    read_run(folder(line + "\n{broken\n" + line + "\n"));
    FAIL() << "a bad line passed";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("results.jsonl line 2"), std::string::npos) << error.what();
  }
}

TEST(Results, AForeignFileCostsOneClearLine) {
  for (const char* foreign : {"{\"solver\": \"nnls\", \"time\": 1}", "[1, 2]", "7",
                              "{\"problem\": 1, \"solver\": 2, \"tolerance\": "
                              "3, \"claimed\": 4, \"verified\": 5, \"conflicting\": 6}"})
    try {
      read_run(folder(std::string(foreign) + "\n"));
      FAIL() << foreign << " passed";
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("results.jsonl line 1: "), std::string::npos) << text;
      EXPECT_EQ(text.find_first_of("\n["), std::string::npos) << text;
    }
}

TEST(Results, SaysWhichFileIsMissing) {
  EXPECT_THROW(
      try { read_run("/nowhere/at/all"); } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "cannot read /nowhere/at/all/results.jsonl");
        throw;
      },
      std::runtime_error);
}

TEST(Results, ALieIsAFalseClaimAndNothingElse) {
  EXPECT_TRUE((Result{.claimed = Status::solved, .metrics = {.verdict = Verdict::wrong}}.lies()));
  EXPECT_TRUE((Result{.claimed = Status::infeasible, .metrics = {.verdict = Verdict::wrong}}.lies()));
  EXPECT_FALSE((Result{.claimed = Status::solved_ill_conditioned, .metrics = {.verdict = Verdict::wrong}}.lies()));
  EXPECT_FALSE((Result{.claimed = Status::iteration_limit, .metrics = {.verdict = Verdict::wrong}}.lies()));
  EXPECT_FALSE((Result{.claimed = Status::solved, .metrics = {.verdict = Verdict::undecided}}.lies()));
}

TEST(Results, QuotesWhatAShellWouldRead) {
  const Result r{.problem_file = "problems/a b.h5", .solver = "nnls:reduce=on", .tolerance = 1e-10};
  EXPECT_EQ(replay_command("runs", r),
            "./zwang solve 'runs/problems/a b.h5' --solver nnls:reduce=on --tolerance 1e-10");
}

TEST(Results, WritesNumbersForPeople) {
  EXPECT_EQ(scientific(3.24e-9), "3.2e-9");
  EXPECT_EQ(scientific(1e-12, 0), "1e-12");
  EXPECT_EQ(scientific(2), "2.0");
  EXPECT_EQ(scientific(0), "0");
  EXPECT_EQ(scientific(unknown), "unknown");
  EXPECT_EQ(scientific(1.7976931348623157e308), "infinite");
  EXPECT_EQ(duration(18.4e-6), "18 us");
  EXPECT_EQ(duration(1.94e-3), "1.9 ms");
  EXPECT_EQ(duration(2.41), "2.4 s");
}

}  // namespace
}  // namespace zwang::report
