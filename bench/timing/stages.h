#pragma once

#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// Where dual_active_set's time goes on a problem of jointed bodies, in seconds of thread CPU time: medians of
// interleaved samples. Its parts are called here in its order; each run goes one part further, and the time it adds is
// that part's (NaN where noise hides it). The solver itself reads no clock.
struct StageTimes {
  double whiten = 0;  // unit rows, body by body (body_rows.h)
  double joints = 0;  // the joint graph's elimination and null space (null_space_form.h)
  double climb = 0;   // reducing violated rows, and the active-set steps (dense_dual_active_set.h)
  double refine = 0;  // the answer, its residuals in double-double, the check of all rows
  double checks = 0;  // of the input, and the search for islands
};

// Problems that the fast path does not take are left at zero.
std::vector<StageTimes> time_stages(const std::vector<Problem>& problems);

}  // namespace zwang
