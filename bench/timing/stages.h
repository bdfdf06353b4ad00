#pragma once

#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// Where dual_active_set's time goes on a problem of jointed bodies, in seconds of thread CPU time: medians of samples
// taken in turn. Its parts are called here in its order, each run from the start up to one more of them, and what that
// one adds is its time (NaN where noise hides it); the solver itself holds no clock.
struct StageTimes {
  double whiten = 0;  // unit rows, body by body (body_rows.h)
  double joints = 0;  // the joint graph's elimination and null space (reduced_form.h)
  double climb = 0;   // rows in reduced form as they are violated, and the steps over them (least_distance.h)
  double refine = 0;  // the answer, its residuals in long double, the rows held against it
  double checks = 0;  // of the input, and the search for islands
};

// Problems that the fast path does not take are left at zero.
std::vector<StageTimes> time_stages(const std::vector<Problem>& problems);

}  // namespace zwang
