// What the speed suite measures: times against a neutral kernel and against each other, warm starts, assembly.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

constexpr const char* ours = "dual_active_set";
constexpr const char* ours_when_large = "newton";

// The floor that earlier measurements of a hand estimate, in runs of the neutral kernel, which took 47 us there: 4.4 us
// for eliminating the joints and 0.25 us for each row that enters or leaves (docs/performance.md).
constexpr double kernel_us = 47, elimination_us = 4.4, step_us = 0.25;
double floor_in_kernels(double steps) { return (elimination_us + step_us * steps) / kernel_us; }

bool is_one_hand(const std::string& family) { return family == "hand" || family == "H"; }

std::string fixed(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return std::isfinite(value) ? text : "";
}

// One solver on all problems of one size of a family.
struct Size {
  std::string family, knob;
  double value = unknown;
  auto operator<=>(const Size&) const = default;
};
struct SpeedTimes {
  std::vector<double> solve_s, kernels, distance, allocations;
  std::vector<double> error;
  int problems = 0, right = 0, unsupported = 0, lies = 0;
  bool bound = false, stopped = false;
  std::string verdict, message;
  double time() const { return median(solve_s); }
};
using BySolver = std::map<std::string, SpeedTimes>;

std::vector<std::pair<Size, BySolver>> by_size(const Run& run) {
  std::vector<std::pair<Size, BySolver>> sizes;
  for (const Result& r : run.results) {
    const Size size{r.family, r.knob, std::isnan(r.knob_value) ? 0 : r.knob_value};
    auto at = std::find_if(sizes.begin(), sizes.end(), [&](const auto& s) { return s.first == size; });
    if (at == sizes.end()) at = sizes.insert(sizes.end(), {size, {}});
    SpeedTimes& t = at->second[r.solver];
    ++t.problems;
    t.unsupported += r.is_blank();
    t.lies += r.lies();
    t.right += r.is_right();
    if (!r.is_right()) t.verdict = r.verified, t.message = r.message;
    if (std::isfinite(r.error())) t.error.push_back(r.error()), t.bound = t.bound || !std::isfinite(r.z_error);
    if (r.repetitions == 0 || r.is_blank()) continue;
    t.stopped = t.stopped || r.claimed == "time limit";
    t.solve_s.push_back(r.solve_s);
    t.kernels.push_back(r.solve_s / r.kernel_s);
    t.allocations.push_back(r.allocations);
    t.distance.push_back(r.solve_s / r.kernel_s / floor_in_kernels(static_cast<double>(r.iterations)));
  }
  std::sort(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return sizes;
}

Cell verdict_cell(const SpeedTimes& t) {
  if (t.unsupported == t.problems) return {"not applicable"};
  std::string text = std::to_string(t.right) + " of " + std::to_string(t.problems);
  if (t.right < t.problems) text += " (" + t.verdict + ")";
  return {text, static_cast<double>(t.right), t.lies > 0 ? "bad" : t.right < t.problems ? "warn" : "good"};
}

std::string size_text(const Size& size) {
  return size.knob.empty() ? size.family : knob_text(size.value) + " " + size.knob;
}

}  // namespace

Table speed_table(const Run& run) {
  Table table{
      "speed",
      "Whole solves from M, z_u, J, c at tolerance 1e-10, cold; medians of interleaved repetitions, and over "
      "the problems of one size. Kernel: Eigen's HouseholderQR of a 96 x 70 matrix, timed in the same sequence. "
      "Floor: the least time of a hand, estimated from measurements of its parts (4.4 us and 0.25 us a step where the "
      "kernel "
      "takes 47 us). Allocations: heap blocks of a warm solve. x ours: against dual_active_set, or newton where that "
      "was not run. A time with > is that of a solver stopped at its deadline, and so is its ratio. mujoco_newton has "
      "soft "
      "rows and serves as a yardstick of speed: its z_error is how far the rows are violated.",
      {{"family"},
       {"size"},
       {"solver"},
       {"time", true},
       {"kernels", true},
       {"x ours", true},
       {"worst z_error", true},
       {"verified"},
       {"allocations", true},
       {"x floor", true}},
      {}};
  for (const auto& [size, solvers] : by_size(run)) {
    std::vector<std::pair<std::string, const SpeedTimes*>> order;
    for (const auto& [solver, times] : solvers) order.emplace_back(solver, &times);
    const auto or_last = [](double time) { return std::isnan(time) ? 1e300 : time; };
    std::sort(order.begin(), order.end(), [&](const auto& a, const auto& b) {
      return std::pair(or_last(a.second->time()), a.first) < std::pair(or_last(b.second->time()), b.first);
    });
    double reference = unknown;
    for (const char* solver : {ours, ours_when_large})
      if (const auto own = solvers.find(solver); own != solvers.end() && std::isnan(reference))
        reference = own->second.time();
    for (const auto& [solver, t] : order) {
      const double ratio = t->time() / reference;
      const double error = t->error.empty() ? unknown : *std::max_element(t->error.begin(), t->error.end());
      const std::string least = t->stopped ? "> " : "";
      const bool floor = solver == ours && is_one_hand(size.family);
      table.rows.push_back({solver,
                            size.family,
                            {{size.family},
                             {size_text(size), size.value},
                             {solver},
                             {std::isfinite(t->time()) ? least + duration(t->time()) : "", t->time()},
                             {fixed(median(t->kernels), 2), median(t->kernels)},
                             {std::isfinite(ratio) ? least + ratio_text(ratio) : "", ratio},
                             {std::isfinite(error) ? (t->bound ? "<= " : "") + scientific(error) : "", error},
                             verdict_cell(*t),
                             {fixed(median(t->allocations), 0), median(t->allocations)},
                             {floor ? fixed(median(t->distance), 1) : "", floor ? median(t->distance) : unknown}},
                            ""});
    }
  }
  return table;
}

Table speed_exponent_table(const Run& run) {
  Table table{"speed-exponents",
              "Time grows like size to the power p, fitted in logarithms to every size in the range.",
              {{"family"}, {"solver"}, {"sizes"}, {"exponent p", true}, {"2 s.e.", true}},
              {}};
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
      table.rows.push_back({solver,
                            family,
                            {{family},
                             {solver},
                             {knob_text(x.front()) + " to " + knob_text(x.back())},
                             {fixed(law.exponent, 2), law.exponent},
                             {fixed(2 * law.error, 2), 2 * law.error}},
                            ""});
    }
  if (table.rows.empty()) table.note = "No solver solved three sizes of a family.";
  return table;
}

Table sequence_table(const Run& run) {
  Table table{
      "sequences",
      "Successive frames, each solved cold and from the same solver's solution of the frame before; all solvers "
      "frame by frame in turn. Every 20th frame is checked. A solver that used up its share of the time has "
      "fewer frames.",
      {{"sequence"},
       {"solver"},
       {"frames", true},
       {"cold", true},
       {"warm", true},
       {"cold / warm", true},
       {"steps cold, warm"},
       {"worst z_error", true},
       {"right", true},
       {"allocations", true}},
      {}};
  for (const SequenceTimes& s : run.sequences) {
    const double gain = s.cold.solve_s / s.warm.solve_s, error = std::fmax(s.cold.worst_z_error, s.warm.worst_z_error);
    const long right = s.cold.right + s.warm.right, checked = s.cold.checked + s.warm.checked;
    table.rows.push_back({s.solver,
                          s.sequence,
                          {{s.sequence},
                           {s.solver},
                           {std::to_string(s.cold.frames), static_cast<double>(s.cold.frames)},
                           {duration(s.cold.solve_s), s.cold.solve_s},
                           {duration(s.warm.solve_s), s.warm.solve_s},
                           {fixed(gain, 2) + "x", gain, gain < 1 ? "warn" : ""},
                           {fixed(s.cold.iterations, 0) + ", " + fixed(s.warm.iterations, 0)},
                           number_cell(error),
                           {std::to_string(right) + " of " + std::to_string(checked), static_cast<double>(right),
                            right == checked ? "good" : "warn"},
                           {fixed(s.warm.allocations, 0), s.warm.allocations}},
                          ""});
  }
  if (table.rows.empty()) table.note = "The run holds no sequences.";
  return table;
}

Table assembly_table(const Run& run) {
  Table table{"assembly",
              "From poses to M, z_u, J, c, while the bodies move and the rows stay; and the search for islands.",
              {{"scene"},
               {"contacts", true},
               {"rows m", true},
               {"assembly", true},
               {"kernels", true},
               {"islands", true},
               {"allocations", true}},
              {}};
  for (const AssemblyTimes& a : run.assembly)
    table.rows.push_back({"",
                          "",
                          {{a.scene},
                           {std::to_string(a.contacts), static_cast<double>(a.contacts)},
                           {std::to_string(a.m), static_cast<double>(a.m)},
                           {duration(a.assemble_s), a.assemble_s},
                           {fixed(a.assemble_s / a.kernel_s, 3), a.assemble_s / a.kernel_s},
                           {duration(a.islands_s), a.islands_s},
                           {std::to_string(a.allocations), static_cast<double>(a.allocations)}},
                          ""});
  if (table.rows.empty()) table.note = "The run holds no assembly times.";
  return table;
}

}  // namespace zwang::report
