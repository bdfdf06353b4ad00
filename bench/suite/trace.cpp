#include <zwang/bench/suite/trace.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/results/result.h>
#include <zwang/bench/suite/schedule.h>

namespace zwang {

std::vector<TracePoint> trace(const Instance& instance, const Run& run, Dispatcher& desk, double time_limit,
                              double budget, const std::atomic<bool>& interrupted) {
  const Problem& problem = instance.problem;
  const Reference* reference = instance.reference ? &*instance.reference : nullptr;
  SolveRequest call;
  call.time_limit = time_limit;
  call.observe = true;
  desk.child.load(problem);
  const SolveReply full = desk.run(problem, run, call, &interrupted);
  if (full.solution.z.size() == 0) return {};

  std::vector<TracePoint> points;
  double spent = full.seconds;
  call.observe = false;
  const int last = std::max(full.solution.iterations, 1);
  for (int k = 1; k <= last && spent < budget && !interrupted; ++k) {
    if (!is_rung(k) && k != last) continue;
    call.max_iterations = k;
    SolveReply capped = desk.run(problem, run, call, &interrupted);
    spent += capped.seconds;
    Solution& at = capped.solution;
    const auto seen =
        std::find_if(full.iterates.begin(), full.iterates.end(), [&](const Iterate& it) { return it.iteration == k; });
    if (k == last)
      at = full.solution;
    else if (seen != full.iterates.end())
      at.z = seen->z, at.lambda = seen->lambda;
    if (at.z.size() == 0) continue;
    const Metrics m = measure(problem, at, reference, run.tolerance);
    const auto finite = [](double x) { return std::isfinite(x) ? x : unknown; };
    points.push_back({.iteration = k,
                      .time_s = capped.seconds,
                      .z_error = finite(m.z_error),
                      .primal = finite(m.primal),
                      .stationarity = finite(m.stationarity),
                      .gap = finite(m.gap)});
  }
  return points;
}

void write_traces(const Plan& plan, const std::filesystem::path& directory, const std::filesystem::path& cache,
                  Dispatcher& desk, double budget, const std::atomic<bool>& interrupted,
                  std::vector<std::string>& notes) {
  std::map<std::pair<std::string, Law>, std::vector<const Instance*>> families;
  for (const Instance& i : plan.instances) families[{i.family, i.problem.law}].push_back(&i);
  for (auto& [family, problems] : families) std::ranges::stable_sort(problems, {}, &Instance::knob_value);
  std::vector<const Instance*> chosen;
  for (std::size_t b = 0; b < plan.instances.size(); ++b) {
    const Instance& i = plan.instances[b];
    const auto& problems = families[{i.family, i.problem.law}];
    if (plan.shard.holds(b) && (plan.options.trace || problems[problems.size() / 2] == &i)) chosen.push_back(&i);
  }
  const double start = wall_seconds();
  std::size_t left = chosen.size(), cut = 0;
  ResultFile out(directory / "traces.jsonl", true);
  for (const Instance* problem : chosen) {
    Instance instance = *problem;
    instance.reference = reference_for(instance, cache, {plan.second_witness}).reference;
    // What is left of the budget is shared by the problems left, and within a problem by the solvers.
    const double share = (budget - (wall_seconds() - start)) / static_cast<double>(left--);
    std::vector<std::string> lines;
    for (const Run& run : plan.tightest_runs()) {
      const double each = share / static_cast<double>(plan.solvers());
      auto points = each > 0 ? trace(instance, run, desk, std::min(plan.time_limit, each), each, interrupted)
                             : std::vector<TracePoint>();
      if (interrupted) return;
      cut += points.empty();
      for (TracePoint& p : points) {
        p.problem = instance.problem.name, p.family = instance.family, p.solver = run.solver;
        lines.push_back(to_json(p));
      }
    }
    out.append(lines);
  }
  if (cut > 0) notes.push_back(std::to_string(cut) + " convergence curves have no points: no answer within their time");
}

}  // namespace zwang
