#include <gtest/gtest.h>

#include <algorithm>

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {
namespace {

Result timed(const std::string& family, double size, const std::string& solver, double solve_s) {
  Result r;
  r.problem = family;
  r.family = family;
  r.knob = "contacts";
  r.knob_value = size;
  r.solver = solver;
  r.claimed = Status::solved;
  r.metrics.verdict = Verdict::solved;
  r.metrics.z_error = 2e-16;
  r.solve_s = solve_s;
  r.kernel_s = 50e-6;
  r.allocations = 0;
  r.iterations = 20;
  r.repetitions = 25;
  return r;
}

RunFolder speed_run() {
  RunFolder run;
  run.solvers = {{.name = "dual_active_set"}, {.name = "ipopt"}};
  for (const double size : {4.0, 16.0, 64.0})
    for (const auto& [solver, time] : {std::pair("dual_active_set", 1e-6 * size), {"ipopt", 1e-3 * size * size}}) {
      run.results.push_back(timed("hand", size, solver, time));
      run.results.push_back(timed("hands", size, solver, time));
    }
  run.sequences = {
      {"hand", "ipopt", {.frames = 9, .solve_s = {.median = 1e-3}}, {.frames = 9, .solve_s = {.median = 2e-3}}}};
  run.assembly = {{.scene = "hand",
                   .contacts = 64,
                   .kernel_s = 50e-6,
                   .assemble_s = {.median = 5e-6},
                   .islands_s = {.median = 4e-6}}};
  return run;
}

const Row& row_of(const Table& table, const std::string& solver, const std::string& size) {
  const auto at = std::find_if(table.rows.begin(), table.rows.end(),
                               [&](const Row& r) { return r.solver == solver && r.cells[1].text == size; });
  if (at == table.rows.end()) throw std::out_of_range("no row " + solver + " " + size);
  return *at;
}

TEST(SpeedTables, TimesStandAgainstTheKernelAndAgainstOurs) {
  const Table table = speed_table(speed_run());
  const Row& ours = row_of(table, "dual_active_set", "16 contacts");
  EXPECT_DOUBLE_EQ(ours.cells[4].value, 16e-6 / 50e-6);
  EXPECT_EQ(ours.cells[7].text, "1 of 1");
  const Row& peer = row_of(table, "ipopt", "16 contacts");
  EXPECT_NEAR(peer.cells[5].value, 16000, 1e-6);
}

TEST(SpeedTables, AStoppedSolverGivesALowerBoundAgainstNewtonWhereOursIsNotRun) {
  RunFolder run;
  run.results = {timed("wall", 1000, "newton", 1e-2), timed("wall", 1000, "ipopt", 20)};
  run.results[1].claimed = Status::time_limit;
  run.results[1].metrics.verdict = Verdict::timeout;
  const Row peer = row_of(speed_table(run), "ipopt", "1000 contacts");
  EXPECT_EQ(peer.cells[3].text.substr(0, 2), "> ");
  EXPECT_EQ(peer.cells[5].text.substr(0, 2), "> ");
  EXPECT_NEAR(peer.cells[5].value, 2000, 1e-9);
}

TEST(SpeedTables, ExponentsAreFittedToAllSizes) {
  const Table table = speed_exponent_table(speed_run());
  ASSERT_EQ(table.rows.size(), 2u) << "one family sweeps its size here";
  EXPECT_NEAR(table.rows[0].cells[3].value, 1, 1e-12);
  EXPECT_NEAR(table.rows[1].cells[3].value, 2, 1e-12);
}

TEST(SpeedTables, AWarmStartThatLosesIsShown) {
  const Table table = sequence_table(speed_run());
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_DOUBLE_EQ(table.rows[0].cells[5].value, 0.5);
  EXPECT_EQ(table.rows[0].cells[5].tone, "warn");
}

TEST(SpeedTables, StandOnThePageOfASpeedRunOnly) {
  const auto holds = [](const auto& run) {
    const auto tables = class_tables(run);
    return std::any_of(tables.begin(), tables.end(), [](const Table& t) { return t.id == "speed"; });
  };
  auto run = speed_run();
  EXPECT_TRUE(holds(run));
  run.sequences.clear();
  run.assembly.clear();
  EXPECT_FALSE(holds(run));
}

}  // namespace
}  // namespace zwang::report
