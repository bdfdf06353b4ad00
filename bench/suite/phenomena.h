#pragma once

#include <atomic>
#include <filesystem>
#include <limits>
#include <span>

#include <zwang/bench/conformance/conformance.h>
#include <zwang/bench/timing/batch.h>

namespace zwang {

// s of CPU time: what all solves together have left, and what one of them may take.
struct SolveTime {
  double left = std::numeric_limits<double>::infinity(), longest = left;
};

// As conformance_solve of a solver, where the dispatcher runs it: a foreign one in the child, which may be stopped.
// What comes when no `time` is left is not solved: "time limit". All but `stated` is kept by the caller.
ConformanceSolve conformance_solve(const Run& run, Dispatcher& desk, SolveTime& time, Law* stated = nullptr,
                                   const std::atomic<bool>* interrupted = nullptr);

// DIR/conformance.jsonl: every solver on every phenomenon of friction (bench/conformance), under the nearest law to
// Coulomb's that it reads. One line a run and phenomenon.
void write_phenomena(const std::filesystem::path& directory, std::span<const Run> runs, Dispatcher& desk,
                     const std::atomic<bool>& interrupted);

}  // namespace zwang
