#pragma once

#include <vector>

#include "bench/suite/batch.h"
#include "core/measure.h"

namespace zwang {

// One point of a convergence chart: the iterate after so many iterations, and the CPU time to get there.
struct TracePoint {
  int iteration;
  double time_s;
  Metrics metrics;
};

// Iterates come from one observed solve. Times come from further solves without observer, each stopped at that
// iteration, since watching costs time. Iterations are taken on a ladder (is_rung) up to the last one. Empty when the
// solver gave no answer within `time_limit` [s of CPU time]; cut short when all solves together exceed `budget` [s].
std::vector<TracePoint> trace(const Instance& instance, const Run& run, Desk& desk, double time_limit, double budget,
                              const std::atomic<bool>& interrupted);

}  // namespace zwang
