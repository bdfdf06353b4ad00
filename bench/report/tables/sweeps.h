#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/statistics.h>

namespace zwang::report {

// Families of the stability atlas: their knob goes from benign to impossible at a fixed size. page/stability.json says
// what each shows.
bool is_stability_family(const std::string& family);

// The run at the tightest tolerance; null where there is none.
const Result* tightest(const std::vector<const Result*>& runs);

// What one solver does over a sweep, problems in file order (benign to hard), each at the tightest tolerance it ran.
struct BreakPoint {
  std::string family = {}, solver = {}, knob = {};
  const Result* fails = nullptr;  // first problem with error > 1e-6, or no answer, or a claim the referee rejects
  const Result* lies = nullptr;   // first of them where the solver claims to be right
  int problems = 0, undecided = 0;
};
std::vector<BreakPoint> break_points(const std::vector<Result>& results, const std::vector<std::string>& solvers);

// One run's state on the sweep: "right", "fails", "lies", "undecided" or "" (unsupported).
std::string sweep_state(const Result& result);

// What is written into its cell beside the colour: "c" crashed, "t" timed out, "w" margins warned, "f" a fallback ran,
// "wf" both, a cross where it fails, a tick where infeasibility is proven, "?" undecided, "".
std::string sweep_mark(const Result& result);

// Time against size in one family.
struct ScalingPoint {
  const Result* result;  // the run drawn (its problem and tolerance)
  std::string solver;
  double size, time_s;
};
struct ScalingFit {
  std::string solver;
  double from, to;  // sizes the fit covers: the upper half of the range, where overheads matter least; three at least
  PowerLaw law;
};
struct Scaling {
  std::string family, axis;  // axis: the knob's name, or "rows m"
  std::vector<ScalingPoint> points;
  std::vector<ScalingFit> fits;
};

// Families with three or more sizes. Time to the achieved error given; median over problems of equal size.
std::vector<Scaling> scaling(const std::vector<Result>& results, const std::vector<std::string>& solvers, double error);

}  // namespace zwang::report
