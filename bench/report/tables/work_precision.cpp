#include <zwang/bench/report/tables/work_precision.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <zwang/bench/report/tables/statistics.h>

namespace zwang::report {
namespace {

constexpr std::size_t single_runs = 6000;  // more, and runs that went well are shown by their medians alone
constexpr int alone_of_kind = 20;          // of a large run, marks of one family, solver and kind

}  // namespace

std::string drawn_as(const Result& r) {
  if (r.is_blank() || r.metrics.verdict == Verdict::infeasible_proven) return "";
  if (r.lies()) return "wrong";
  if (r.metrics.verdict == Verdict::solved) return std::isfinite(r.error()) ? "ok" : "";
  if (std::isfinite(r.metrics.z_error)) return "missed";
  if (r.is_open() || r.metrics.verdict == Verdict::near) return "undecided";
  return "failed";
}

std::vector<DrawnRun> work_precision_points(const RunFolder& run) {
  std::vector<DrawnRun> points;
  std::map<std::string, std::set<std::string>> problems;  // by family
  std::map<std::string, double> slowest;
  for (const Result& r : run.results) {
    problems[r.family].insert(r.problem);
    if (std::isfinite(r.solve_s)) slowest[r.family] = std::max(slowest[r.family], r.solve_s);
  }

  // A family of which most problems have no z has no error to draw: the sweep shows who proves it.
  std::map<std::string, std::set<std::string>> infeasible;
  for (const Result& r : run.results)
    if (r.feasible == std::optional(false)) infeasible[r.family].insert(r.problem);
  const auto undrawn = [&](const Result& r) {
    return drawn_as(r).empty() || 2 * infeasible[r.family].size() > problems[r.family].size();
  };

  // Medians over the problems of a family that the solver got right at this tolerance, where those are more than half:
  // medians over few easy ones, others at every tolerance, would draw a line to and fro.
  std::set<const Result*> lone;  // right, but not part of a median
  std::map<std::tuple<std::string, std::string, double>, std::vector<const Result*>> cells;
  for (const Result& r : run.results)
    if (!undrawn(r)) cells[{r.family, r.solver, r.tolerance}].push_back(&r);
  for (const auto& [key, runs] : cells) {
    std::vector<const Result*> ok;
    std::vector<double> error, time, q1, q3, prepare, iterations;
    for (const Result* r : runs) {
      if (drawn_as(*r) != "ok") continue;
      ok.push_back(r);
      error.push_back(r->error());
      time.push_back(r->solve_s);
      q1.push_back(r->solve_s_q1);
      q3.push_back(r->solve_s_q3);
      if (std::isfinite(r->prepare_s)) prepare.push_back(r->prepare_s);
      iterations.push_back(static_cast<double>(r->iterations));
    }
    if (2 * ok.size() <= runs.size()) lone.insert(ok.begin(), ok.end());
    if (ok.empty() || lone.contains(ok.front())) continue;
    const double middle = median(time);
    const Result& typical =
        **std::ranges::min_element(ok, {}, [middle](const Result* r) { return std::abs(r->solve_s - middle); });
    const std::string of = "median of " + std::to_string(ok.size()) + " solved of " + std::to_string(runs.size());
    const bool several = problems[typical.family].size() > 1;
    points.push_back({several ? "median" : "single", &typical, median(error), middle, median(q1), median(q3),
                      median(prepare), median(iterations), several ? of : "one run"});
  }

  const bool all = run.results.size() <= single_runs;
  std::map<std::tuple<std::string, std::string, std::string>, int> alone;
  for (const Result& r : run.results) {
    const std::string drawn = drawn_as(r);
    if (undrawn(r) || (drawn == "ok" && !lone.contains(&r) && (!all || problems[r.family].size() == 1))) continue;
    if (run.is_large() && ++alone[{r.family, r.solver, drawn}] > alone_of_kind) continue;
    const double time = std::isfinite(r.solve_s) && r.solve_s > 0 ? r.solve_s : slowest[r.family];
    const double error = std::isfinite(r.error()) ? r.error() : r.metrics.friction.self_bound;
    points.push_back({lone.contains(&r) ? "lone" : "run", &r, error, time, r.solve_s_q1, r.solve_s_q3, r.prepare_s,
                      static_cast<double>(r.iterations), "one run"});
  }
  return points;
}

}  // namespace zwang::report
