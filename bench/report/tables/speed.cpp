// What the speed suite measures: times against a neutral kernel and against each other, warm starts, assembly.

#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

constexpr const char* ours = "dual_active_set";
constexpr const char* ours_when_large = "newton";
constexpr const char* ours_with_friction = "cone";

// One solver on all problems of one size of a family.
struct Size {
  std::string family, knob;
  double value = unknown;
  auto operator<=>(const Size&) const = default;
};
struct SpeedTimes {
  std::vector<double> solve_s, kernels, allocations, error;
  int problems = 0, right = 0, unsupported = 0, lies = 0;
  bool bound = false, stopped = false;
  std::string verdict;
  double time() const { return median(solve_s); }
};

std::map<Size, std::map<std::string, SpeedTimes>> by_size(const RunFolder& run) {
  std::map<Size, std::map<std::string, SpeedTimes>> sizes;
  for (const Result& r : run.results) {
    SpeedTimes& t = sizes[{r.family, r.knob, std::isnan(r.knob_value) ? 0 : r.knob_value}][r.solver];
    ++t.problems;
    t.unsupported += r.is_blank();
    t.lies += r.lies();
    t.right += r.is_right();
    if (!r.is_right()) t.verdict = r.verdict();
    if (std::isfinite(r.error())) t.error.push_back(r.error()), t.bound = t.bound || !std::isfinite(r.metrics.z_error);
    if (r.repetitions == 0 || r.is_blank()) continue;
    t.stopped = t.stopped || r.claimed == Status::time_limit;
    t.solve_s.push_back(r.solve_s);
    t.kernels.push_back(r.solve_s / r.kernel_s);
    t.allocations.push_back(r.allocations);
  }
  return sizes;
}

Cell verdict_cell(const SpeedTimes& t) {
  if (t.unsupported == t.problems) return "not applicable";
  Cell cell = part_cell(t.right, t.problems, t.lies > 0 ? "bad" : t.right < t.problems ? "warn" : "good");
  if (t.right < t.problems) cell.text += " (" + t.verdict + ")";
  return cell;
}

// "> 1.2 ms" where a solver was stopped, "" where there is no value.
Cell at_least(bool stopped, double value, const std::string& text) {
  return {std::isfinite(value) ? (stopped ? "> " : "") + text : "", value};
}

}  // namespace

Table speed_table(const RunFolder& run) {
  Table table("speed");
  for (const auto& [size, solvers] : by_size(run)) {
    std::vector<std::pair<std::string, const SpeedTimes*>> order;
    for (const auto& [solver, times] : solvers) order.emplace_back(solver, &times);
    std::ranges::sort(order, {}, [](const auto& entry) {
      const double time = entry.second->time();
      return std::pair(std::isnan(time) ? 1e300 : time, entry.first);
    });
    double reference = unknown;
    for (const char* solver : {ours, ours_when_large, ours_with_friction})
      if (const auto own = solvers.find(solver); own != solvers.end() && std::isnan(reference))
        reference = own->second.time();
    for (const auto& [solver, t] : order) {
      const double time = t->time(), ratio = time / reference;
      const double error = t->error.empty() ? unknown : std::ranges::max(t->error);
      table.add(
          solver, size.family,
          {size.family, Cell(size.knob.empty() ? size.family : knob_text(size.value) + " " + size.knob, size.value),
           solver, at_least(t->stopped, time, duration(time)), fixed_cell(median(t->kernels), 2),
           at_least(t->stopped, ratio, ratio_text(ratio)),
           Cell(std::isfinite(error) ? (t->bound ? "<= " : "") + scientific(error) : "", error), verdict_cell(*t),
           fixed_cell(median(t->allocations), 0)});
    }
  }
  table.explain();
  return table;
}

Table speed_exponent_table(const RunFolder& run) {
  Table table("speed-exponents");
  const auto sizes = by_size(run);
  // Walls begin at 100 boxes: below, set-up dominates.
  const std::map<std::string, double> families{{"hands", 1}, {"K", 1}, {"tower", 10}, {"wall", 100}, {"random", 1}};
  for (const auto& [family, from] : families)
    for (const std::string& solver : names(run)) {
      std::vector<double> x, y;
      for (const auto& [size, solvers] : sizes) {
        const auto at = solvers.find(solver);
        if (size.family != family || size.value < from || at == solvers.end()) continue;
        if (at->second.right + (at->second.verdict == "undecided" ? 1 : 0) == 0 || at->second.solve_s.empty()) continue;
        x.push_back(size.value);
        y.push_back(at->second.time());
      }
      if (x.size() < 3) continue;
      const PowerLaw law = fit_power_law(x, y);
      table.add(solver, family,
                {family, solver, knob_text(x.front()) + " to " + knob_text(x.back()), fixed_cell(law.exponent, 2),
                 fixed_cell(2 * law.error, 2)});
    }
  table.explain();
  return table;
}

Table sequence_table(const RunFolder& run) {
  Table table("sequences");
  for (const SequenceTimes& s : run.sequences) {
    const double gain = s.cold.solve_s.median / s.warm.solve_s.median;
    const long right = s.cold.right + s.warm.right, checked = s.cold.checked + s.warm.checked;
    table.add(s.solver, s.sequence,
              {s.sequence, s.solver, whole_cell(s.cold.frames), time_cell(s.cold.solve_s.median),
               time_cell(s.warm.solve_s.median), Cell(fixed(gain, 2) + "x", gain, gain < 1 ? "warn" : ""),
               fixed(s.cold.iterations, 0) + ", " + fixed(s.warm.iterations, 0),
               number_cell(std::fmax(s.cold.worst_z_error, s.warm.worst_z_error)),
               part_cell(right, checked, right == checked ? "good" : "warn"), fixed_cell(s.warm.allocations, 0)});
  }
  table.explain();
  return table;
}

Table assembly_table(const RunFolder& run) {
  Table table("assembly");
  for (const AssemblyTimes& a : run.assembly)
    table.add(
        "", "",
        {a.scene, whole_cell(a.contacts), whole_cell(a.m), time_cell(a.assemble_s.median),
         fixed_cell(a.assemble_s.median / a.kernel_s, 3), time_cell(a.islands_s.median), whole_cell(a.allocations)});
  table.explain();
  return table;
}

}  // namespace zwang::report
