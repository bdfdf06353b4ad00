#include <zwang/bench/report/tables/tables.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <zwang/bench/report/page/page.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/tables/work_precision.h>
#include <zwang/bench/report/wording.h>
#include "tests/bench/report/one_run.h"

namespace zwang::report {
namespace {

// A right answer to a simpler law is right, and how far it is from Coulomb's stands beside it.
TEST(Tables, LawsStandSideBySide) {
  RunFolder all;
  for (const char* law : {"pyramid", "convex", "coulomb"}) {
    Result r = run("a", law == std::string("pyramid") ? "newton" : "cone", 1e-10, 1e-14, 1e-3);
    r.law = law;
    if (r.law != "coulomb") {
      r.problem += " (" + r.law + ")";
      r.family += " (" + r.law + ")";
      r.coulomb_error = 0.25;
    }
    all.results.push_back(r);
  }
  all.results.push_back(run("b", "newton", 1e-10, 1e-14, 1e-3));  // without friction
  all.results.back().family = "g";
  all.results.back().law = "frictionless";
  all.solvers = {{.name = "newton"}, {.name = "cone"}};
  const Table table = law_table(all);
  ASSERT_EQ(table.rows.size(), 3u);
  for (const Row& row : table.rows) {
    EXPECT_EQ(row.group, "f");
    EXPECT_EQ(row.cells[4].text, "1 of 1");
    EXPECT_EQ(row.cells[8].value, row.cells[1].text == "coulomb" ? 1e-14 : 0.25);
  }
  EXPECT_TRUE(law_table(RunFolder()).rows.empty());
}

TEST(Tables, PhenomenaSayPassOrByHowMuch) {
  RunFolder all;
  all.phenomena = {{"cone", "coulomb", "ROD", "one of three", 0, true, true},
                   {"cone", "coulomb", "belt", "carried", 0.375, false, true},
                   {"pgs", "pyramid", "ROD", "one of three", unknown, false, true},
                   {"pgs", "pyramid", "belt", "carried", unknown, false, false}};
  const Table table = conformance_table(all);
  ASSERT_EQ(table.rows.size(), 2u);
  ASSERT_EQ(table.columns.size(), 5u);
  const auto text = [&](std::size_t row, std::size_t cell) { return table.rows[row].cells[cell].text; };
  EXPECT_EQ(text(0, 2), "1");
  EXPECT_EQ(text(0, 3), "ok");
  EXPECT_EQ(text(0, 4), "0.38");
  EXPECT_EQ(text(1, 1), "pyramid");
  EXPECT_EQ(text(1, 3), "none");
  EXPECT_EQ(text(1, 4), "");
  EXPECT_EQ(phenomenon_table(all).rows.size(), 2u);
}

TEST(Tables, LiesStandFirstWithTheCommandThatReplaysTheWorst) {
  RunFolder all;
  all.results = {run("p", "s", 1e-8, 1e-3, 1, Status::solved_ill_conditioned, Verdict::wrong),
                 run("p", "s", 1e-10, 1e-2, 1, Status::solved, Verdict::wrong),
                 run("p", "s", 1e-12, 1e-1, 1, Status::solved, Verdict::wrong),
                 run("p", "s", 1e-2, 1e-1, 1, Status::iteration_limit, Verdict::wrong)};
  for (Result& r : all.results) r.replay = scientific(r.tolerance, 0);
  const Table table = claims_table(all);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].command, "1e-12");
  EXPECT_EQ(table.rows[0].cells[2].text, "1e-10 to 1e-12");
  EXPECT_EQ(table.rows[0].cells[4].tone, "bad");
  EXPECT_EQ(table.rows[1].cells[4].text, "solved, ill-conditioned");
}

TEST(Tables, FalseClaimsAreCountedBySolver) {
  RunFolder all;
  all.solvers = {{.name = "honest"}, {.name = "s"}, {.name = "t"}};
  all.results = {run("p", "s", 1e-8, 1e-3, 1, Status::solved_ill_conditioned, Verdict::wrong),
                 run("p", "s", 1e-10, 1e-2, 1, Status::solved, Verdict::wrong),
                 run("p", "t", 1e-12, 1e-3, 1, Status::solved, Verdict::wrong),
                 run("q", "t", 1e-12, 1e-1, 1, Status::solved, Verdict::wrong),
                 run("q", "honest", 1e-2, 1e-1, 1, Status::iteration_limit, Verdict::wrong)};
  const Table table = claim_counts_table(all);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].solver, "t");
  EXPECT_EQ(table.rows[0].cells[1].value, 2);
  EXPECT_EQ(table.rows[0].cells[3].value, 2);
  EXPECT_EQ(table.rows[0].cells[4].value, 1e-1);
  EXPECT_EQ(table.rows[1].cells[1].value, 1);
  EXPECT_EQ(table.rows[1].cells[5].value, 1) << "flagged, but wrong";
}

TEST(Tables, PowersOfTwoFarFromOne) {
  EXPECT_EQ(knob_text(std::ldexp(1, -27)), "2^-27");
  EXPECT_EQ(knob_text(std::ldexp(1, 48)), "2^48");
  EXPECT_EQ(knob_text(64), "64");
  EXPECT_EQ(knob_text(-std::ldexp(1, -20)), "-2^-20");
}

TEST(Compare, TwoVersionsOfASolverSideBySideOnTheSameProblems) {
  RunFolder a, b;
  a.results = {run("p", "s", 1e-8, 1e-9, 4), run("q", "s", 1e-8, 1e-9, 1)};
  b.results = {run("p renamed", "s", 1e-8, 1e-9, 1), run("r", "s", 1e-8, 1e-9, 1),
               run("p renamed", "new", 1e-8, 1e-9, 2)};
  a.results[0].problem_sha256 = b.results[0].problem_sha256 = b.results[2].problem_sha256 = "same";
  a.solvers = {{.name = "s"}, {.name = "gone"}};
  b.solvers = {{.name = "s"}, {.name = "new"}};
  const RunFolder both = merged(a, b);
  ASSERT_EQ(both.solvers.size(), 4u);
  EXPECT_EQ(both.solvers[0].name, "s @A");
  EXPECT_EQ(both.solvers[1].name, "s @B");
  EXPECT_EQ(both.solvers[2].name, "gone");
  EXPECT_EQ(both.solvers[3].name, "new");
  EXPECT_EQ(both.results[2].problem, "p");
  const Table table = comparison_table(a, b);
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0].cells[1].value, 1);              // one problem in both
  EXPECT_NEAR(table.rows[0].cells[4].value, 0.25, 1e-12);  // B needs a quarter of the time
  EXPECT_NE(table.note.find("Only in run A: gone. Only in run B: new."), std::string::npos);
}

TEST(Headline, SaysWhoseAnswersAndTimesTheyAre) {
  RunFolder all;
  all.results.assign(1200, run("p", "cone", 1e-8, 1e-9, 1));
  for (std::size_t k = 0; k < 1200; ++k) all.results[k].problem = std::to_string(k % 600);
  all.handed_over[{"cone", "dual_active_set"}] = {"p0", "p1"};
  all.solvers = {{.name = "cone"}};
  const std::vector<std::string> lines = headline(all);
  EXPECT_EQ(lines[0], "1,200 runs of 1 solver on 600 problems: 1,200 right.");
  EXPECT_EQ(lines.back(),
            "Handed over, and counted for the solver that answered alone: cone to dual_active_set on 2 problems.");
  all.handed_over.clear();
  EXPECT_EQ(headline(all).back().find("Handed over"), std::string::npos);
}

// One family under three laws, in which a solver of one class is a thousand times as fast as those of another.
RunFolder under_three_laws() {
  RunFolder all;
  all.solvers = {{.name = "qp_solver"}, {.name = "cone_solver"}};
  for (const char* law : {"frictionless", "pyramid", "convex", "coulomb"})
    for (const char* solver : {"qp_solver", "cone_solver"}) {
      const bool is_qp = law == std::string("frictionless") || law == std::string("pyramid");
      const bool reads = is_qp || solver == std::string("cone_solver");
      Result& r = all.results.emplace_back(run(std::string("p under ") + law, solver, 1e-10, reads ? 1e-14 : unknown,
                                               solver == std::string("cone_solver") ? 1 : 1e-3,
                                               reads ? Status::solved : Status::unsupported,
                                               reads ? Verdict::solved : Verdict::unsupported));
      r.law = law;
      all.traces.push_back({.problem = r.problem, .solver = solver});
    }
  return all;
}

TEST(Classes, AreNeverAveraged) {
  const std::vector<RunFolder> classes = by_class(under_three_laws());
  ASSERT_EQ(classes.size(), 3u);
  EXPECT_EQ(classes[0].problem_class, "QP");
  EXPECT_EQ(classes[1].problem_class, "convex cone");
  EXPECT_EQ(classes[2].problem_class, "Coulomb");
  EXPECT_EQ(classes[0].solvers.size(), 2u);
  EXPECT_EQ(classes[1].solvers.size(), 1u) << "who reads no problem of a class is not in it";
  EXPECT_EQ(classes[0].traces.size(), 4u);
  EXPECT_EQ(classes[2].traces.size(), 2u);
  EXPECT_EQ(accuracy_headline(classes[0]),
            "QP: on 2 f problems at 1e-9 achieved error: qp_solver 1.0 ms, cone_solver 1.0 s (1000x)");
  EXPECT_EQ(accuracy_headline(classes[2]), "Coulomb: on one f problem at 1e-9 achieved error: cone_solver 1.0 s");
  const Table means = means_table(classes[0]);
  EXPECT_EQ(means.rows[0].cells[1].text, "2 of 2");
  EXPECT_NEAR(means.rows[0].cells[2].value, 1e-3, 1e-12);
  EXPECT_EQ(means_table(classes[1]).rows[0].cells[1].text, "1 of 1");
  for (const RunFolder& part : classes)
    for (const Table& table : class_tables(part))
      for (const Row& row : table.rows) EXPECT_NE(row.cells[0].text, part.problem_class == "QP" ? "" : "qp_solver");
}

TEST(Classes, ARunOfOneClassHasNoNameForIt) {
  RunFolder all = under_three_laws();
  std::erase_if(all.results, [](const Result& r) { return r.law == "convex" || r.law == "coulomb"; });
  const std::vector<RunFolder> classes = by_class(all);
  ASSERT_EQ(classes.size(), 1u);
  EXPECT_EQ(classes[0].problem_class, "");
  EXPECT_EQ(classes[0].results.size(), 4u);
  EXPECT_EQ(by_class(RunFolder()).size(), 1u);
}

TEST(Charts, ErrorsAtTheEdgeOfDoubleAreStillNumbers) {
  RunFolder all;
  all.results = {run("p", "s", 1e-8, std::numeric_limits<double>::max(), 1, Status::iteration_limit, Verdict::wrong)};
  all.solvers = {{.name = "s"}};
  EXPECT_NE(chart_rows(all).find("1e+300"), std::string::npos);
}

TEST(Charts, HowARunIsDrawn) {
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-9, 1)), "ok");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-3, 1, Status::solved, Verdict::wrong)), "wrong");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, 1e-3, 1, Status::iteration_limit, Verdict::wrong)), "missed");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, Status::solved, Verdict::undecided)), "undecided");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, Status::time_limit, Verdict::timeout)), "failed");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, Status::unsupported, Verdict::unsupported)), "");
  EXPECT_EQ(drawn_as(run("p", "s", 1e-8, unknown, 1, Status::infeasible, Verdict::infeasible_proven)), "");
}

TEST(Tables, RecordedAnswersCountByVerdictAndTheirErrorsAreThoseThatWereMeasured) {
  RunFolder all;
  all.recorded = {run("a", "recorded:somebody", 1e-10, 1e-3, unknown, Status::unsolved, Verdict::wrong),
                  run("b", "recorded:somebody", 1e-10, 1e-16, unknown, Status::unsolved, Verdict::solved),
                  run("c", "recorded:somebody", 1e-10, unknown, unknown, Status::unsolved, Verdict::undecided)};
  all.recorded[2].metrics.z_bound = 1e308;
  const Table table = recorded_table(all);
  ASSERT_EQ(table.rows.size(), 1u);
  std::vector<double> values;
  for (std::size_t k = 2; k < table.columns.size(); ++k) values.push_back(table.rows[0].cells[k].value);
  EXPECT_EQ(values, (std::vector<double>{3, 1, 0, 1, 1, 1e-16, (1e-16 + 1e-3) / 2, 1e-3}));
  EXPECT_EQ(recorded_table(RunFolder()).rows.size(), 0u);
}

}  // namespace
}  // namespace zwang::report
