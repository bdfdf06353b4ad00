#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include <zwang/bench/results/result.h>
#include <zwang/bench/suite/plan.h>

namespace zwang {

// Where references are kept between runs, since they take longer than the solves they judge:
// $XDG_CACHE_HOME/zwang/references, or the like under $HOME.
std::filesystem::path reference_cache();

// "" or one line: the optional solvers that this program was built without, by what they need.
std::string not_built_in(std::span<const AbsentSolver> absent);

// What run_suite has done.
struct Outcome {
  Tally tally = {};         // lines in results.jsonl, those of before a resume included
  std::size_t planned = 0;  // lines when complete
  std::size_t earlier = 0;  // lines that a resume found there
  double seconds = 0;       // wall clock of this call
  bool interrupted = false;
  std::vector<std::string> notes = {};  // what was cut to keep the time; run.json holds more
};

struct SuiteSettings {
  std::filesystem::path directory = {};  // of the results (docs/formats.md)
  std::filesystem::path cache = {};      // of references; empty: none is kept
  std::string command = {};              // for run.json
  bool quiet = false;                    // show no progress at all
  std::span<const SolverEntry> solvers = zwang::solvers();
  std::function<void(Result&)> amend = {};  // the last word on a row before it is stored
  std::function<void()> between = {};       // called between two problems, when nothing is timed
};

// Runs the plan, one flow (flow.h) a problem, into settings.directory, and skips what is finished there. Each problem's
// lines are on the disk before the next begins.
Outcome run_suite(const Plan& plan, const SuiteSettings& settings, const std::atomic<bool>& interrupted);

}  // namespace zwang
