#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// The achieved errors at which solvers are compared.
inline constexpr double error_levels[] = {1e-3, 1e-6, 1e-9, 1e-12};
inline constexpr double headline_error = 1e-9;

// Results of one problem, by solver (the order of `solvers`): the pointers point into the results given.
struct ProblemRuns {
  std::string problem, family;
  std::vector<std::vector<const Result*>> by_solver;
};
std::vector<ProblemRuns> group_by_problem(const std::vector<Result>& results, const std::vector<std::string>& solvers);

// Time [s] in which one solver reaches the error (Result::error) on one problem: the cheapest of the runs that achieved
// it and of the crossings between neighbours on the tolerance ladder (interpolated in logarithms). Infinite where none
// does; NaN where every run is blank: the solver does not read the problem. Runs that lie never count, and on an
// infeasible problem only a proof does.
double time_to_error(const std::vector<const Result*>& runs, double error);

// One solver's time in a family at equal achieved error.
struct AccuracyMatched {
  std::string solver;
  double time_s;  // geometric mean over the problems on which the error was reached
  double ratio;   // to the leading solver, geometric mean over the problems both reached; 1 for the leader
  int reached, reads, problems;  // of all problems it reads some, and reaches the error on some of those
};

// Most problems first, then the fastest. Solvers that reach the error nowhere are left out. family "" means all.
// Results of one class of problems.
std::vector<AccuracyMatched> accuracy_matched(const std::vector<Result>& results, const std::string& family,
                                              double error);

// The family a run is best summed up by: the hands, else the one most solvers reach 1e-9 on. "" when there is none.
std::string headline_family(const std::vector<Result>& results);

// "On 3 hands at 1e-9 achieved error: dual_active_set 18 us, nnls 104 us (5.8x); not on all: pgs 90 us (4.1x, 2 of 3)",
// of the headline family, behind the class's name; "" when no solver reaches it. The leader is the fastest of those
// that reach it most often; a part is of the problems that the solver reads.
std::string accuracy_headline(const RunFolder& of_class, double error = headline_error);

std::string ratio_text(double ratio);  // "5.8x"

}  // namespace zwang::report
