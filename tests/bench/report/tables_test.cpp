#include <zwang/bench/report/tables/tables.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <zwang/bench/report/compare.h>
#include <zwang/bench/report/page/charts.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/tables/work_precision.h>
#include <zwang/bench/report/wording.h>
#include "tests/bench/report/one_run.h"

namespace zwang::report {
namespace {

TEST(Tables, LiesStandFirstWithTheCommandThatReplaysTheWorst) {
  report::Run all;
  all.results = {run("p", "s", 1e-8, 1e-3, 1, "solved, ill-conditioned", "wrong"),
                 run("p", "s", 1e-10, 1e-2, 1, "solved", "wrong"), run("p", "s", 1e-12, 1e-1, 1, "solved", "wrong"),
                 run("p", "s", 1e-2, 1e-1, 1, "iteration limit", "wrong")};
  for (Result& r : all.results) r.replay = scientific(r.tolerance, 0);
  const Table table = claims_table(all);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].command, "1e-12");
  EXPECT_EQ(table.rows[0].cells[2].text, "1e-10 to 1e-12");
  EXPECT_EQ(table.rows[0].cells[4].tone, "bad");
  EXPECT_EQ(table.rows[1].cells[4].text, "solved, ill-conditioned");
}

TEST(Tables, FalseClaimsAreCountedBySolver) {
  report::Run all;
  all.solvers = {{.name = "honest"}, {.name = "s"}, {.name = "t"}};
  all.results = {run("p", "s", 1e-8, 1e-3, 1, "solved, ill-conditioned", "wrong"),
                 run("p", "s", 1e-10, 1e-2, 1, "solved", "wrong"), run("p", "t", 1e-12, 1e-3, 1, "solved", "wrong"),
                 run("q", "t", 1e-12, 1e-1, 1, "solved", "wrong"),
                 run("q", "honest", 1e-2, 1e-1, 1, "iteration limit", "wrong")};
  const Table table = claim_counts_table(all);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].solver, "t");
  EXPECT_EQ(table.rows[0].cells[1].value, 2);
  EXPECT_EQ(table.rows[0].cells[3].value, 2);
  EXPECT_EQ(table.rows[0].cells[4].value, 1e-1);
  EXPECT_EQ(table.rows[1].cells[1].value, 1);
  EXPECT_EQ(table.rows[1].cells[5].value, 1) << "flagged, but wrong";
}

TEST(Tables, FilesEscapeWhatTheirFormatReads) {
  Table table("t", "a_b; #x, y");
  table.add("", "", {"50 %", Cell("2.0 us", 2e-6)});
  EXPECT_EQ(to_csv(table), "a_b,\"x, y\"\n50 %,2e-06\n");
  EXPECT_NE(to_tex(table).find("a\\_b & x, y \\\\"), std::string::npos);
  EXPECT_NE(to_tex(table).find("50 \\% & 2.0 $\\mu$s \\\\"), std::string::npos);
}

TEST(Tables, PowersOfTwoFarFromOne) {
  EXPECT_EQ(knob_text(std::ldexp(1, -27)), "2^-27");
  EXPECT_EQ(knob_text(std::ldexp(1, 48)), "2^48");
  EXPECT_EQ(knob_text(64), "64");
  EXPECT_EQ(knob_text(-std::ldexp(1, -20)), "-2^-20");
}

TEST(Compare, TwoVersionsOfASolverSideBySideOnTheSameProblems) {
  report::Run a, b;
  a.results = {run("p", "s", 1e-8, 1e-9, 4), run("q", "s", 1e-8, 1e-9, 1)};
  b.results = {run("p renamed", "s", 1e-8, 1e-9, 1), run("r", "s", 1e-8, 1e-9, 1),
               run("p renamed", "new", 1e-8, 1e-9, 2)};
  a.results[0].problem_sha256 = b.results[0].problem_sha256 = b.results[2].problem_sha256 = "same";
  a.solvers = {{.name = "s"}};
  b.solvers = {{.name = "s"}, {.name = "new"}};
  const report::Run both = merged(a, b);
  ASSERT_EQ(both.solvers.size(), 3u);
  EXPECT_EQ(both.solvers[0].name, "s @A");
  EXPECT_EQ(both.solvers[1].name, "s @B");
  EXPECT_EQ(both.solvers[2].name, "new");
  EXPECT_EQ(both.results[2].problem, "p");
  const Table table = comparison_table(a, b);
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0].cells[1].value, 1);              // one problem in both
  EXPECT_NEAR(table.rows[0].cells[4].value, 0.25, 1e-12);  // B needs a quarter of the time
  EXPECT_NE(table.note.find("Only in run B: new"), std::string::npos);
}

TEST(Charts, ErrorsAtTheEdgeOfDoubleAreStillNumbers) {
  report::Run all;
  all.results = {run("p", "s", 1e-8, std::numeric_limits<double>::max(), 1, "iteration limit", "wrong")};
  all.solvers = {{.name = "s"}};
  EXPECT_NE(chart_rows(all).find("1e+300"), std::string::npos);
}

TEST(Charts, HowARunIsDrawn) {
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-9, 1)), "ok");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-3, 1, "solved", "wrong")), "wrong");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-3, 1, "iteration limit", "wrong")), "missed");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, "solved", "undecided")), "undecided");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, "time limit", "timeout")), "failed");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, "unsupported", "unsupported")), "");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, "infeasible", "infeasible, proven")), "");
}

TEST(Tables, RecordedAnswersCountByVerdictAndTheirErrorsAreThoseThatWereMeasured) {
  report::Run all;
  all.recorded = {run("a", "recorded:somebody", 1e-10, 1e-3, unknown, "unsolved", "wrong"),
                  run("b", "recorded:somebody", 1e-10, 1e-16, unknown, "unsolved", "solved"),
                  run("c", "recorded:somebody", 1e-10, unknown, unknown, "unsolved", "undecided")};
  all.recorded[2].z_bound = 1e308;
  const Table table = recorded_table(all);
  ASSERT_EQ(table.rows.size(), 1u);
  std::vector<double> values;
  for (std::size_t k = 2; k < table.columns.size(); ++k) values.push_back(table.rows[0].cells[k].value);
  EXPECT_EQ(values, (std::vector<double>{3, 1, 0, 1, 1, 1e-16, (1e-16 + 1e-3) / 2, 1e-3}));
  EXPECT_EQ(recorded_table(report::Run()).rows.size(), 0u);
}

}  // namespace
}  // namespace zwang::report
