#include <zwang/bench/report/tables/sweeps.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <zwang/bench/report/tables/in_order.h>

namespace zwang::report {
namespace {

constexpr double broken = 1e-6;  // an error above this is a broken answer, whatever the tolerance

// The size a family sweeps: its knob where rows or columns grow with it, else the rows.
double size_of(const Result& r) { return std::isfinite(r.knob_value) ? r.knob_value : static_cast<double>(r.m); }

}  // namespace

const Result* tightest(const std::vector<const Result*>& runs) {
  const auto it = std::ranges::min_element(runs, {}, &Result::tolerance);
  return it == runs.end() ? nullptr : *it;
}

bool is_stability_family(const std::string& family) {
  static const std::set<std::string> families = {
      "MR",   "MR1",  "MRC",  "NPE", "NPI",  "WED",   "LOOP", "MANYF", "MANYR", "GAP",   "INC",
      "UNIT", "ROW",  "HUGE", "ANI", "WEAK", "CHAIN", "STK",  "PIVOT", "FLIP",  "HAND",  "MU0",
      "MUL",  "APEX", "SLIP", "MRF", "STKF", "RANK",  "JAM",  "HELD",  "ROD",   "PINCH", "PUCK"};
  return families.contains(family);
}

std::string sweep_state(const Result& r) {
  if (r.is_blank()) return "";
  const bool infeasible_right = r.metrics.verdict == Verdict::infeasible_proven;
  if (infeasible_right || (r.metrics.z_error <= broken && r.feasible != std::optional(false))) return "right";
  if (r.lies()) return "lies";
  const bool answer = std::isfinite(r.metrics.z_error);
  if (answer && r.claims_solved()) return "lies";  // wrong by more than 1e-6 and says solved, at the tightest tolerance
  if (!answer && r.is_open()) return "undecided";
  if (r.metrics.verdict == Verdict::infeasible_claimed && r.feasible == std::optional(false)) return "undecided";
  if (!answer && (r.metrics.verdict == Verdict::solved || r.metrics.verdict == Verdict::near))
    return r.metrics.z_bound <= broken ? "right" : "undecided";
  return "fails";
}

std::string sweep_mark(const Result& r) {
  const std::string state = sweep_state(r);
  if (state.empty() || state == "lies") return "";
  if (r.metrics.verdict == Verdict::crashed) return "c";
  if (r.metrics.verdict == Verdict::timeout) return "t";
  if (state == "fails") return r.claimed == Status::solved_ill_conditioned ? "w" : "\u00d7";
  if (state == "undecided") return "?";
  const bool warned = r.claimed == Status::solved_ill_conditioned;
  if (warned || r.fallback) return warned && r.fallback ? "wf" : warned ? "w" : "f";
  return std::isfinite(r.metrics.z_error) ? "" : "\u2713";
}

std::vector<BreakPoint> break_points(const std::vector<Result>& results, const std::vector<std::string>& solvers) {
  InOrder<std::pair<std::string, std::string>, BreakPoint> found;
  for (const ProblemRuns& group : group_by_problem(results, solvers)) {
    if (!is_stability_family(group.family)) continue;
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      const Result* r = tightest(group.by_solver[s]);
      if (!r) continue;
      BreakPoint& point = found[{group.family, solvers[s]}];
      if (point.solver.empty()) point = {.family = group.family, .solver = solvers[s], .knob = r->knob};
      const std::string state = sweep_state(*r);
      if (state.empty()) continue;
      ++point.problems;
      if (state == "undecided") ++point.undecided;
      if ((state == "fails" || state == "lies") && !point.fails) point.fails = r;
      if (state == "lies" && !point.lies) point.lies = r;
    }
  }
  std::vector<BreakPoint> table;
  for (const auto& [key, point] : found.items) table.push_back(point);
  return table;
}

std::vector<Scaling> scaling(const std::vector<Result>& results, const std::vector<std::string>& solvers,
                             double error) {
  std::vector<Scaling> all;
  const std::vector<ProblemRuns> groups = group_by_problem(results, solvers);
  for (const std::string& family : families_of(results)) {
    std::set<double> sizes;
    std::set<std::pair<long, long>> shapes;
    std::string axis = "rows m";
    for (const Result& r : results)
      if (r.family == family && size_of(r) > 0) {
        sizes.insert(size_of(r));
        shapes.insert({r.n, r.m});
        if (std::isfinite(r.knob_value) && !r.knob.empty()) axis = r.knob;
      }
    if (sizes.size() < 3 || shapes.size() < 3) continue;
    Scaling family_scaling{family, axis, {}, {}};
    const double middle = std::min(std::sqrt(*sizes.begin() * *sizes.rbegin()), *std::next(sizes.rbegin(), 2));
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      std::map<double, std::vector<double>> times;
      std::map<double, const Result*> example;
      for (const ProblemRuns& group : groups) {
        if (group.family != family || group.by_solver[s].empty()) continue;
        const Result* r = tightest(group.by_solver[s]);
        const double t = time_to_error(group.by_solver[s], error), size = size_of(*r);
        if (!std::isfinite(t) || !(size > 0)) continue;
        times[size].push_back(t);
        example[size] = r;
      }
      std::vector<double> x, y;
      for (const auto& [size, seconds] : times) {
        const double t = std::max(median(seconds), 1e-9);
        family_scaling.points.push_back({example[size], solvers[s], size, t});
        if (size >= middle * (1 - 1e-12)) x.push_back(size), y.push_back(t);
      }
      if (x.size() >= 3) family_scaling.fits.push_back({solvers[s], x.front(), x.back(), fit_power_law(x, y)});
    }
    all.push_back(family_scaling);
  }
  return all;
}

}  // namespace zwang::report
