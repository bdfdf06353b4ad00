#pragma once

#include <string>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// A line of results.jsonl of the family "f".
inline Result run(const std::string& problem, const std::string& solver, double tolerance, double error, double seconds,
                  Status claimed = Status::solved, Verdict verdict = Verdict::solved) {
  Result r;
  r.problem = problem;
  r.family = "f";
  r.solver = solver;
  r.tolerance = tolerance;
  r.metrics.z_error = error;
  r.solve_s = seconds;
  r.claimed = claimed;
  r.metrics.verdict = verdict;
  return r;
}

}  // namespace zwang::report
