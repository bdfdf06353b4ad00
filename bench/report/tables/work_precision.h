#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// How a run is drawn in the work-precision diagram: "ok", "missed" (stopped short, and said so), "wrong" (claimed
// success), "undecided", "failed" (no answer), or "" (blank: unsupported, or a proof of infeasibility).
std::string drawn_as(const Result& result);

// A mark of the work-precision diagram.
struct DrawnRun {
  std::string level;  // "median" over the problems of a family; "single" where it has one; "run"; "lone": a right run
                      // without a median to stand behind
  const Result* run;  // of medians the run nearest to it, which stands for it in the tooltip
  double error, time_s, q1_s, q3_s, prepare_s, iterations;
  std::string of;  // "median of 9 solved of 10"
};
std::vector<DrawnRun> work_precision_points(const RunFolder& run);

}  // namespace zwang::report
