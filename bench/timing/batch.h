#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <zwang/bench/results/statistics.h>
#include <zwang/bench/timing/child.h>
#include <zwang/core/problem/instance.h>
#include <zwang/solvers/registry.h>

namespace zwang {

// A solver as somebody asked for it, at one tolerance.
struct Run {
  std::string solver = {};
  bool foreign = false;
  double tolerance = 1e-10;
  std::string accuracy = {};                     // SolveOptions::read_accuracy
  double least_time_limit = 0;                   // s: BatchLimits may not give it less
  Index largest_island = SolverEntry::any_size;  // unknowns: it is not run on problems with a larger one
};

// Where runs take place: native solvers here, foreign ones in the child.
struct Dispatcher {
  // By default of those that are registered.
  explicit Dispatcher(MakeSolver make = [](std::string_view text) { return make_solver(text); })
      : here(make), child(std::move(make)) {}
  SolveReply run(const Problem& problem, const Run& run, SolveRequest call, const std::atomic<bool>* interrupted);

  SolveService here;
  Child child;
};

struct BatchLimits {
  double time_limit = 1;  // s of CPU time a solve
  double budget = 1;      // s for all repetitions of the batch together
  bool repeat = true;     // else first solves alone, without the neutral kernel
  int repetitions = 0;    // of every run; 0: as many as the budget allows, at most `most`
  static constexpr int most = 25;
};

// What one run of a batch left: the first solve's solution, and the time of each repetition (empty: only the first
// solve was timed).
struct Timed {
  Solution solution = {};
  double first_s = 0;
  std::vector<double> samples = {};
  double first_prepare_s = 0;          // of first_s: bringing the problem into the method's form
  std::vector<double> prepare_s = {};  // likewise of each repetition
  double allocations = 0;              // heap blocks a solve asks for once it is warm
};

// fraction: of the batch, 0..1. Never called while a clock runs.
using BatchProgress = std::function<void(double fraction, std::size_t run)>;

// Runs of one problem, timed side by side. `runs` holds a solver's tolerances from loose to tight: once a solver has
// met the time limit, its tighter runs are not made, and their message says so. So does that of a run that is kept from
// large islands.
//
// Every run is solved once by a fresh solver (whose surplus over the median is the set-up time) and once more as
// warm-up; then the repetitions of all runs are shuffled into one sequence, so that a slow minute of the machine hits
// all solvers alike. A sample is the mean of as many solves as fill 50 us. Runs without an answer
// are not repeated. `kernel` gets samples of the neutral kernel (neutral_kernel.h) from the same sequence. Empty when
// interrupted.
std::vector<Timed> time_batch(const Problem& problem, std::span<const Run> runs, const BatchLimits& limits,
                              Dispatcher& desk, const std::atomic<bool>& interrupted, const BatchProgress& progress,
                              std::vector<double>* kernel = nullptr);

// How often each run may repeat so that all fit into the budget [s]: every run gets the same time, runs that need less
// leave the rest to the others, and none gets more than `most`.
std::vector<int> share_budget(std::span<const double> seconds, double budget, int most);

}  // namespace zwang
