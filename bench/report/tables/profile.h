#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/tables/accuracy.h>

namespace zwang::report {

// times[problem][solver] [s], infinite where the solver failed, was wrong or lied, NaN where it does not read the
// problem.
using Times = std::vector<std::vector<double>>;
Times times_to_error(const std::vector<ProblemRuns>& groups, const std::string& family, double error);

struct Step {
  double at;     // ratio to the fastest solver, or seconds
  double share;  // of the problems that the solver reads
};
using Curve = std::vector<Step>;  // a right-continuous staircase: holds from `at` on

// Dolan-More: share of problems solved within tau times the fastest solver's time. A problem that no solver solves
// stays in the denominator: it is a failure of all.
std::vector<Curve> performance_profile(const Times& times);

// More-Wild, with seconds as the budget: share of problems solved within that time.
std::vector<Curve> data_profile(const Times& times);

// Shifted geometric mean [s] per solver over the problems that it reads and at least one solver solved; a failure
// counts as `penalty` times the slowest success on that problem (a mean cannot hold an infinity; the profile does).
std::vector<double> shifted_geometric_means(const Times& times, double shift, double penalty);

// Median of all successes [s], rounded to one digit: the shift that treats half the times as small.
double natural_shift(const Times& times);

}  // namespace zwang::report
