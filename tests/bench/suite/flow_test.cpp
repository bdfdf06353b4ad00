#include <zwang/bench/suite/flow.h>

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/suite/suite.h>
#include "tests/bench/suite/test_solvers.h"
#include "tests/folders.h"

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

Instance assembled_hand() {
  Instance instance = to_instance(
      pose_hands({{"hands", 1}, {"contacts", 4}, {"limits", 5}, {"drift", 0}, {"feasible", 1}, {"seed", 1}}));
  instance.problem.name = "hand";
  return instance;
}

std::vector<Cell> cells_of(const std::function<Instance()>& assemble, const std::vector<Run>& runs,
                           double recorded_tolerance = 0) {
  std::vector<Cell> all;
  Dispatcher dispatcher([](std::string_view text) { return make_solver(text); });
  const Flow flow{.assemble = assemble,
                  .runs = runs,
                  .limits = {.budget = 0.01},
                  .append = [&](const Instance&, std::vector<Cell>& cells) { all = std::move(cells); },
                  .recorded_tolerance = recorded_tolerance};
  EXPECT_TRUE(run_flow(flow, dispatcher, tests::never));
  return all;
}

// But for what names the line within its run, and for times. A problem that is read back takes its family from the
// file.
Json of_the_problem(const std::string& line) {
  Json row = Json::parse(line);
  for (const char* key : {"problem_file", "batch", "setup_s", "kernel_s", "solve_s", "solve_s_q1", "solve_s_q3",
                          "prepare_s", "repetitions", "family", "machine", "cell", "check"})
    row.erase(key);
  return row;
}

TEST(Flow, GivesARowPerRunThatSaysWhatTheSuiteSays) {
  Plan plan;
  plan.options.solvers = "dual_active_set,newton";
  plan.options.tolerances = {1e-10};
  plan.time_limit = 5;
  plan.runs = {{.solver = "dual_active_set"}, {.solver = "newton"}};
  plan.instances = {assembled_hand()};
  const auto directory = own_path("flow");
  std::filesystem::remove_all(directory);
  run_suite(plan, {.directory = directory, .command = "test"}, tests::never);

  // The suite's reference is not given to the flow: both judge by it where it is.
  const auto assemble = [&] { return read_problems(directory / "problems/0000.h5").at(0); };
  const std::vector<Cell> cells = cells_of(assemble, plan.runs);
  std::ifstream file(directory / "results.jsonl");
  ASSERT_EQ(cells.size(), 2u);
  for (const Cell& cell : cells) {
    std::string line;
    ASSERT_TRUE(std::getline(file, line));
    EXPECT_EQ(of_the_problem(to_json(cell.result)), of_the_problem(line));
    EXPECT_EQ(cell.result.metrics.verdict, Verdict::solved);
    EXPECT_GT(cell.result.solve_s, 0);
  }
  std::filesystem::remove_all(directory);
}

TEST(Flow, SaysWhyALargeIslandIsNotGivenToADenseMethod) {
  const std::vector<Cell> cells = cells_of([] { return assembled_hand(); }, {{.solver = "nnls", .largest_island = 95},
                                                                             {.solver = "nnls", .largest_island = 96}});
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].result.claimed, Status::unsupported);
  EXPECT_EQ(cells[0].result.message, "not run: dense, and one island has 96 unknowns");
  EXPECT_EQ(cells[0].result.repetitions, 0);
  EXPECT_EQ(cells[1].result.claimed, Status::solved);
}

// Also where the problem is too large for a reference.
TEST(Flow, ARecordedAnswerIsMeasuredAgainstAProvenOne) {
  Solution exact;
  make_solver("dual_active_set").solve(assembled_hand().problem, {}, exact);
  const auto assemble = [&](double off) {
    Instance instance = assembled_hand();
    EXPECT_FALSE(instance.reference);
    instance.recorded = {{"somebody", exact.z + off * (instance.problem.z_u - exact.z)}};
    return instance;
  };
  const zwang::Run rough{.solver = "pgs:max_sweeps=1"}, right{.solver = "newton"};
  const std::vector<Cell> near = cells_of([&] { return assemble(1e-4); }, {rough, right}, 1e-10);
  const std::vector<Cell> far = cells_of([&] { return assemble(2e-4); }, {rough, right}, 1e-10);
  ASSERT_EQ(near.size(), 3u);
  EXPECT_EQ(near[0].result.solver, "recorded:somebody");
  EXPECT_EQ(near[0].result.reference, "proven answer of newton");
  EXPECT_EQ(near[0].result.reference_bound, near[2].result.metrics.z_bound);
  EXPECT_EQ(near[0].result.metrics.verdict, Verdict::wrong);
  EXPECT_NEAR(far[0].result.metrics.z_error / near[0].result.metrics.z_error, 2, 1e-9);
  EXPECT_EQ(near[2].result.reference, "") << "a solver is no other solver's judge";
  const std::vector<Cell> alone = cells_of([&] { return assemble(1e-4); }, {rough}, 1e-10);
  EXPECT_EQ(alone[0].result.reference, "") << "an unproven answer stands for nothing";
}

TEST(Flow, AppendsNothingWhenInterrupted) {
  Dispatcher dispatcher([](std::string_view text) { return make_solver(text); });
  const std::atomic<bool> at_once = true;
  const Flow flow{.assemble = assembled_hand,
                  .runs = {{.solver = "nnls"}},
                  .append = [](const Instance&, const std::vector<Cell>&) { FAIL(); }};
  EXPECT_FALSE(run_flow(flow, dispatcher, at_once));
}

}  // namespace
}  // namespace zwang
