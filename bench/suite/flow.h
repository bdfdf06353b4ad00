#pragma once

#include <functional>
#include <vector>

#include <zwang/bench/results/result.h>
#include <zwang/bench/timing/batch.h>

namespace zwang {

// What one run left of one problem: the row of results, and the solve it was measured from (of a recorded answer:
// none).
struct Cell {
  Result result = {};
  Timed timed = {};
};

// One problem on its way through the program.
struct Flow {
  std::function<Instance()> assemble = {};  // the problem, with what is known to be true of it
  std::vector<Run> runs = {};               // a solver's tolerances from loose to tight
  BatchLimits limits = {};                  // of time
  // One cell a recorded answer, then one a run, in the order of the runs.
  std::function<void(const Instance&, std::vector<Cell>&)> append = {};
  double recorded_tolerance = 0;  // at which the problem's recorded answers are judged; 0: they are left out
  BatchProgress progress = [](double, std::size_t) {};
};

// scene -> assemble -> problem -> solve -> solution -> measure -> results. Every result of `solve` and `bench` is made
// here. False when interrupted; nothing is appended then.
bool run_flow(const Flow& flow, Dispatcher& dispatcher, const std::atomic<bool>& interrupted);

}  // namespace zwang
