#include "bench/suite/trace.h"

#include <algorithm>

namespace zwang {

std::vector<TracePoint> trace(const Instance& instance, const Run& run, Desk& desk, double time_limit, double budget,
                              const std::atomic<bool>& interrupted) {
  const Problem& problem = instance.problem;
  const Reference* reference = instance.reference ? &*instance.reference : nullptr;
  Call call;
  call.time_limit = time_limit;
  call.observe = true;
  desk.child.load(problem);
  const Answer full = desk.run(problem, run, call, &interrupted);
  if (full.solution.z.size() == 0) return {};

  std::vector<TracePoint> points;
  double spent = full.seconds;
  call.observe = false;
  const int last = std::max(full.solution.iterations, 1);
  for (int k = 1; k <= last && spent < budget && !interrupted; ++k) {
    if (!is_rung(k) && k != last) continue;
    call.max_iterations = k;
    Answer capped = desk.run(problem, run, call, &interrupted);
    spent += capped.seconds;
    Solution& at = capped.solution;
    const auto seen =
        std::find_if(full.iterates.begin(), full.iterates.end(), [&](const Iterate& it) { return it.iteration == k; });
    if (k == last)
      at = full.solution;
    else if (seen != full.iterates.end())
      at.z = seen->z, at.lambda = seen->lambda;
    if (at.z.size() == 0) continue;
    points.push_back({k, capped.seconds, measure(problem, at, reference, run.tolerance)});
  }
  return points;
}

}  // namespace zwang
