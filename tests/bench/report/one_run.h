#pragma once

#include <string>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// A line of results.jsonl of the family "f".
inline Result run(const std::string& problem, const std::string& solver, double tolerance, double error, double seconds,
                  const std::string& claimed = "solved", const std::string& verified = "solved") {
  Result r;
  r.problem = problem;
  r.family = "f";
  r.solver = solver;
  r.tolerance = tolerance;
  r.z_error = error;
  r.solve_s = seconds;
  r.claimed = claimed;
  r.verified = verified;
  return r;
}

}  // namespace zwang::report
