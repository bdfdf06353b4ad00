#pragma once

#include <vector>

#include <zwang/bench/results/records.h>
#include <zwang/core/problem/problem.h>

namespace zwang {

// Where dual_active_set's time goes on each problem of jointed bodies: medians of interleaved samples. Its parts are
// called here in its order; each run goes one part further, and the time it adds is that part's (NaN where noise hides
// it). The solver itself reads no clock. Problems that the fast path does not take are left at zero.
std::vector<StageTimes> time_stages(const std::vector<Problem>& problems);

}  // namespace zwang
