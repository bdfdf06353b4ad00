#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/results/records.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/bench/timing/batch.h>

namespace zwang {

// The points of a convergence curve, without names. Iterates come from one observed solve. Times come from further
// solves without observer, each stopped at that iteration, since watching costs time. Iterations are taken on a ladder
// (is_rung) up to the last one. Empty when the solver gave no answer within `time_limit` [s of CPU time]; cut short
// when all solves together exceed `budget` [s].
std::vector<TracePoint> trace(const Instance& instance, const Run& run, Dispatcher& desk, double time_limit,
                              double budget, const std::atomic<bool>& interrupted);

// DIR/traces.jsonl: convergence of every solver on the problem in the middle of each family's knob (on every problem
// with --trace), at the tightest tolerance, within `budget` [s]. A note says how many curves that left without points.
void write_traces(const Plan& plan, const std::filesystem::path& directory, const std::filesystem::path& cache,
                  Dispatcher& desk, double budget, const std::atomic<bool>& interrupted,
                  std::vector<std::string>& notes);

}  // namespace zwang
