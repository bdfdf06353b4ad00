// Aggregations against values worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/profile.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/tables/sweeps.h>
#include "tests/bench/report/one_run.h"

namespace zwang::report {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double reach(const std::vector<Result>& results, double error) {
  std::vector<const Result*> runs;
  for (const Result& r : results) runs.push_back(&r);
  return time_to_error(runs, error);
}

TEST(Statistics, MedianSkipsTheUnknown) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, unknown, 2, 3}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, GeometricMeanWithAndWithoutShift) {
  EXPECT_NEAR(geometric_mean({1, 100}), 10, 1e-12);
  EXPECT_NEAR(geometric_mean({1, 7}, 1), 3, 1e-12);  // sqrt(2 * 8) - 1
}

TEST(Statistics, PowerLawOfExactDataHasNoError) {
  const PowerLaw law = fit_power_law({1, 2, 4, 8}, {3, 12, 48, 192});
  EXPECT_NEAR(law.factor, 3, 1e-12);
  EXPECT_NEAR(law.exponent, 2, 1e-12);
  EXPECT_NEAR(law.error, 0, 1e-7);
}

TEST(Statistics, PowerLawErrorOfThreePoints) {
  // In logarithms to base e: x = 0, 1, 2; y = 0, 2, 1. Slope 1/2, residuals -1/2, 1, -1/2: s.e. = sqrt(1.5 / 1 / 2).
  const PowerLaw law = fit_power_law({1, std::exp(1), std::exp(2)}, {1, std::exp(2), std::exp(1)});
  EXPECT_NEAR(law.exponent, 0.5, 1e-12);
  EXPECT_NEAR(law.error, std::sqrt(0.75), 1e-12);
}

TEST(Accuracy, InterpolatesBetweenRungsInLogarithms) {
  // 1e-2 in 1 s, 1e-6 in 100 s: 1e-4 lies half way, at 10 s.
  const std::vector<Result> ladder = {run("p", "s", 1e-2, 1e-2, 1), run("p", "s", 1e-6, 1e-6, 100)};
  EXPECT_NEAR(reach(ladder, 1e-4), 10, 1e-9);
  EXPECT_EQ(reach(ladder, 1e-1), 1);
  EXPECT_NEAR(reach(ladder, 1e-6), 100, 1e-9);
  EXPECT_EQ(reach(ladder, 1e-7), infinite);
}

TEST(Accuracy, TakesTheCheapestRunThatReachesTheError) {
  EXPECT_EQ(reach({run("p", "s", 1e-2, 1e-15, 7), run("p", "s", 1e-6, 1e-15, 5), run("p", "s", 1e-8, 0, 6)}, 1e-9), 5);
}

TEST(Accuracy, WithoutAReferenceTheUpperBoundStandsIn) {
  Result r = run("p", "s", 1e-8, unknown, 3);
  r.metrics.z_bound = 1e-10;
  EXPECT_EQ(reach({r}, 1e-9), 3);
  EXPECT_EQ(reach({r}, 1e-11), infinite);
}

TEST(Accuracy, LiesNeverCount) {
  EXPECT_EQ(reach({run("p", "s", 1e-14, 1e-4, 1, Status::solved, Verdict::wrong)}, 1e-3), infinite);
  EXPECT_EQ(reach({run("p", "s", 1e-14, 1e-4, 1, Status::iteration_limit, Verdict::wrong)}, 1e-3), 1);
}

TEST(Accuracy, PartsAreOfTheProblemsThatASolverReads) {
  const auto of = [](const std::string& problem, const std::string& solver, double seconds, Verdict verdict) {
    const bool solved = verdict == Verdict::solved;
    return run(problem, solver, 1e-9, solved ? 1e-12 : unknown, seconds, solved ? Status::solved : Status::unsupported,
               verdict);
  };
  RunFolder all;
  all.problem_class = "QP";
  all.results = {of("p", "every", 1, Verdict::solved),   of("q", "every", 1, Verdict::solved),
                 of("r", "every", 1, Verdict::solved),   of("p", "some", 3, Verdict::solved),
                 of("q", "some", 2, Verdict::no_answer), of("r", "some", 9, Verdict::unsupported)};
  const auto table = accuracy_matched(all.results, "f", 1e-9);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table[1].reached, 1);
  EXPECT_EQ(table[1].reads, 2);
  EXPECT_EQ(table[1].problems, 3);
  EXPECT_EQ(accuracy_headline(all),
            "QP: on 3 f problems at 1e-9 achieved error: every 1.0 s; not on all: some 3.0 s (3.0x, 1 of 2)");
  EXPECT_TRUE(std::isnan(reach({all.results[5]}, 1e-9)));
}

TEST(Accuracy, OnlyAProofCountsOnAnInfeasibleProblem) {
  EXPECT_EQ(reach({run("p", "s", 1e-6, unknown, 2, Status::infeasible, Verdict::infeasible_proven)}, 1e-9), 2);
  EXPECT_EQ(reach({run("p", "s", 1e-6, unknown, 2, Status::infeasible, Verdict::infeasible_claimed)}, 1e-9), infinite);
}

TEST(Accuracy, RanksBySolvedProblemsThenByTimeWithRatiosOnCommonProblems) {
  const std::vector<Result> results = {run("p", "slow", 1e-9, 1e-12, 4),      run("q", "slow", 1e-9, 1e-12, 9),
                                       run("p", "quick", 1e-9, 1e-12, 1),     run("q", "quick", 1e-9, 1e-12, 1),
                                       run("p", "partial", 1e-9, 1e-12, 0.5), run("q", "partial", 1e-9, 1e-3, 0.5)};
  const auto table = accuracy_matched(results, "f", 1e-9);
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table[0].solver, "quick");
  EXPECT_EQ(table[0].ratio, 1);
  EXPECT_EQ(table[1].solver, "slow");
  EXPECT_NEAR(table[1].time_s, 6, 1e-12);
  EXPECT_NEAR(table[1].ratio, 6, 1e-12);
  EXPECT_EQ(table[2].solver, "partial");
  EXPECT_EQ(table[2].reached, 1);
  EXPECT_EQ(table[2].problems, 2);
  EXPECT_NEAR(table[2].ratio, 0.5, 1e-12);
  RunFolder all;
  all.results = results;
  EXPECT_EQ(
      accuracy_headline(all, 1e-9),
      "On 2 f problems at 1e-9 achieved error: quick 1.0 s, slow 6.0 s (6.0x); not on all: partial 500 ms (0.5x, 1 "
      "of 2)");
  EXPECT_TRUE(accuracy_matched(results, "another", 1e-9).empty());
  EXPECT_EQ(accuracy_headline(all, 1e-14), "");
}

// Three problems, two solvers; nobody solves the third.
const Times times = {{1, 2}, {6, 3}, {infinite, infinite}};

TEST(Profile, StaircaseOfRatiosKeepsUnsolvedProblemsInTheDenominator) {
  const auto curves = performance_profile(times);
  ASSERT_EQ(curves.size(), 2u);
  ASSERT_EQ(curves[0].size(), 2u);
  EXPECT_EQ(curves[0][0].at, 1);
  EXPECT_NEAR(curves[0][0].share, 1.0 / 3, 1e-15);
  EXPECT_EQ(curves[0][1].at, 2);
  EXPECT_NEAR(curves[0][1].share, 2.0 / 3, 1e-15);
}

TEST(Profile, EqualRatiosAreOneStep) {
  const auto curves = performance_profile({{1, 2}, {2, 4}});
  ASSERT_EQ(curves[1].size(), 1u);
  EXPECT_EQ(curves[1][0].at, 2);
  EXPECT_EQ(curves[1][0].share, 1);
}

TEST(Profile, AProblemThatASolverDoesNotReadIsNoFailure) {
  const Times read_in_part = {{1, unknown}, {2, 4}, {infinite, 3}, {infinite, infinite}};
  const auto ratios = performance_profile(read_in_part), budgets = data_profile(read_in_part);
  EXPECT_EQ(ratios[0].back().share, 2.0 / 4);
  EXPECT_NEAR(ratios[1].back().share, 2.0 / 3, 1e-15);
  EXPECT_EQ(ratios[1].back().at, 2);
  EXPECT_NEAR(budgets[1].back().share, 2.0 / 3, 1e-15);
  EXPECT_NEAR(shifted_geometric_means(read_in_part, 0, 10)[1], std::sqrt(12.0), 1e-12);
}

TEST(Profile, DataProfileCountsSeconds) {
  const auto curves = data_profile(times);
  ASSERT_EQ(curves[0].size(), 2u);
  EXPECT_EQ(curves[0][1].at, 6);
  EXPECT_NEAR(curves[0][1].share, 2.0 / 3, 1e-15);
}

TEST(Profile, AFailureCostsTheMeanTenTimesTheSlowestSuccess) {
  const auto means = shifted_geometric_means({{1, infinite}, {4, 1}}, 0, 10);
  EXPECT_NEAR(means[0], 2, 1e-12);
  EXPECT_NEAR(means[1], std::sqrt(10.0), 1e-12);
  EXPECT_EQ(natural_shift({{1.9e-5, infinite}, {3.3e-5, 2.4e-5}}), 2e-5);
}

Result sweep_run(double knob, double error, Status claimed, Verdict verdict) {
  Result r = run("mr " + std::to_string(knob), "s", 1e-10, error, 1, claimed, verdict);
  r.family = "MR";
  r.knob = "ratio";
  r.knob_value = knob;
  return r;
}

TEST(Sweeps, FirstFailureAndFirstLieInFileOrder) {
  const std::vector<Result> results = {sweep_run(1, 1e-15, Status::solved, Verdict::solved),
                                       sweep_run(16, 1e-5, Status::iteration_limit, Verdict::wrong),
                                       sweep_run(256, unknown, Status::solved, Verdict::undecided),
                                       sweep_run(4096, 1e-2, Status::solved, Verdict::wrong)};
  const auto points = break_points(results, {"s"});
  ASSERT_EQ(points.size(), 1u);
  ASSERT_NE(points[0].fails, nullptr);
  EXPECT_EQ(points[0].fails->knob_value, 16);
  ASSERT_NE(points[0].lies, nullptr);
  EXPECT_EQ(points[0].lies->knob_value, 4096);
  EXPECT_EQ(points[0].undecided, 1);
  EXPECT_EQ(points[0].problems, 4);
}

TEST(Sweeps, TheTightestToleranceSpeaksForASolver) {
  std::vector<Result> results = {sweep_run(1, 1e-3, Status::solved, Verdict::solved),
                                 sweep_run(1, 1e-12, Status::solved, Verdict::solved)};
  results[0].tolerance = 1e-2;
  EXPECT_EQ(break_points(results, {"s"})[0].fails, nullptr);
}

TEST(Sweeps, MarksOfASingleRun) {
  const auto mark = [](double error, Status claimed, Verdict verdict, bool fallback = false) {
    Result r = sweep_run(1, error, claimed, verdict);
    r.fallback = fallback;
    return sweep_mark(r);
  };
  EXPECT_EQ(mark(1e-15, Status::solved, Verdict::solved), "");
  EXPECT_EQ(mark(1e-15, Status::solved, Verdict::solved, true), "f");
  EXPECT_EQ(mark(1e-15, Status::solved_ill_conditioned, Verdict::solved), "w");
  EXPECT_EQ(mark(1e-15, Status::solved_ill_conditioned, Verdict::solved, true), "wf");
  EXPECT_EQ(mark(1e-2, Status::solved_ill_conditioned, Verdict::wrong), "w");
  EXPECT_EQ(mark(unknown, Status::time_limit, Verdict::timeout), "t");
  EXPECT_EQ(mark(unknown, Status::crashed, Verdict::crashed), "c");
  EXPECT_EQ(mark(1e-2, Status::iteration_limit, Verdict::wrong), "\u00d7");
  EXPECT_EQ(mark(1e-2, Status::solved, Verdict::wrong), "") << "a lie has a mark of its own";
}

TEST(Sweeps, StatesOfASingleRun) {
  EXPECT_EQ(sweep_state(sweep_run(1, unknown, Status::infeasible, Verdict::infeasible_proven)), "right");
  EXPECT_EQ(sweep_state(sweep_run(1, unknown, Status::infeasible, Verdict::wrong)), "lies");
  EXPECT_EQ(sweep_state(sweep_run(1, unknown, Status::unsupported, Verdict::unsupported)), "");
  EXPECT_EQ(sweep_state(sweep_run(1, unknown, Status::time_limit, Verdict::timeout)), "fails");
  EXPECT_EQ(sweep_state(sweep_run(1, 1e-4, Status::solved_ill_conditioned, Verdict::wrong)), "fails");
}

TEST(Sweeps, ExponentOverTheUpperHalfOfTheSizes) {
  std::vector<Result> results;
  for (const int size : {1, 2, 4, 8, 16, 32, 64}) {
    Result r = run(std::to_string(size), "s", 1e-8, 1e-9, size < 8 ? 1.0 : size * size / 64.0);
    r.knob = "boxes";
    r.knob_value = size;
    r.m = size;
    r.n = 6 * size;
    results.push_back(r);
  }
  const auto families = scaling(results, {"s"}, 1e-6);
  ASSERT_EQ(families.size(), 1u);
  EXPECT_EQ(families[0].axis, "boxes");
  EXPECT_EQ(families[0].points.size(), 7u);
  ASSERT_EQ(families[0].fits.size(), 1u);
  EXPECT_EQ(families[0].fits[0].from, 8);
  EXPECT_NEAR(families[0].fits[0].law.exponent, 2, 1e-9);
}

}  // namespace
}  // namespace zwang::report
