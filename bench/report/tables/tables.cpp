#include <zwang/bench/report/tables/tables.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/sweeps.h>

namespace zwang::report {

std::string knob_text(double value) {
  if (!std::isfinite(value)) return "";
  int exponent = 0;
  if (const double mantissa = std::frexp(std::abs(value), &exponent);
      mantissa == 0.5 && (exponent < -2 || exponent > 10))
    return std::string(value < 0 ? "-" : "") + "2^" + std::to_string(exponent - 1);
  return printed("%.6g", value);
}

Table break_point_table(const RunFolder& run) {
  Table table("break-points");
  std::vector<std::string> families;
  std::map<std::string, std::map<std::string, BreakPoint>> found;
  for (const BreakPoint& point : break_points(run.results, names(run))) {
    if (std::ranges::find(families, point.family) == families.end()) {
      families.push_back(point.family);
      table.columns.push_back({point.family + (point.knob.empty() ? "" : " (" + point.knob + ")")});
    }
    found[point.solver][point.family] = point;
  }
  const auto at = [](const Result* r) {
    return !r ? "never" : std::isfinite(r->knob_value) ? knob_text(r->knob_value) : r->problem;
  };
  for (const std::string& solver : names(run)) {
    if (!found.contains(solver)) continue;
    std::vector<Cell> cells = {solver};
    for (const std::string& family : families) {
      const BreakPoint& p = found[solver][family];
      Cell& cell = cells.emplace_back("unsupported");
      if (p.problems == 0) continue;
      cell = {at(p.fails) + " / " + at(p.lies), p.fails ? p.fails->knob_value : unknown,
              p.fails && !p.lies ? "warn" : tone_of(p.lies, true)};
      if (p.undecided) cell.text += " (" + std::to_string(p.undecided) + " undecided)";
    }
    table.add(solver, "", std::move(cells));
  }
  table.explain();
  return table;
}

Table reference_table(const RunFolder& run) {
  Table table("references");
  for (const std::string& family : families_of(run.results)) {
    std::map<std::string, std::set<std::string>> by_reference;
    std::set<std::string> problems, infeasible;
    for (const Result& r : run.results) {
      if (r.family != family) continue;
      problems.insert(r.problem);
      by_reference[r.reference.empty() ? "none (bound only)" : r.reference].insert(r.problem);
      if (r.feasible == std::optional(false)) infeasible.insert(r.problem);
    }
    std::vector<std::string> origins;
    for (const auto& [name, which] : by_reference)
      origins.push_back(name + (by_reference.size() > 1 ? ": " + std::to_string(which.size()) : ""));
    table.add("", family,
              {family, whole_cell(std::ssize(problems)), joined(origins, "; "), count_cell(infeasible.size())});
  }
  table.explain();
  return table;
}

Table solver_table(const RunFolder& run) {
  Table table("solvers");
  for (const SolverInfo& s : run.solvers)
    table.add(s.name, "", {s.name, s.method, s.limits, s.foreign ? "a child process" : "this process"});
  table.explain();
  return table;
}

Table conditions_table(const RunFolder& run) {
  Table table("conditions");
  for (const auto& [name, value] : run.conditions) table.add("", "", {name, value});
  table.explain();
  return table;
}

std::vector<Table> common_tables(const RunFolder& run) {
  std::vector<Table> tables = {claim_counts_table(run), claims_table(run), verdict_table(run),   worst_row_table(run),
                               reference_table(run),    solver_table(run), conditions_table(run)};
  if (run.is_of_speed()) tables.push_back(assembly_table(run));
  for (Table& table : std::vector{law_table(run), conformance_table(run), phenomenon_table(run)})
    if (!table.rows.empty()) tables.push_back(std::move(table));
  if (!run.sequences.empty()) tables.push_back(sequence_table(run));
  if (!run.recorded.empty()) tables.push_back(recorded_table(run));
  return tables;
}

std::vector<Table> class_tables(const RunFolder& run) {
  std::vector<Table> tables = {accuracy_table(run), means_table(run), break_point_table(run), exponent_table(run),
                               range_gap_table(run)};
  if (run.is_of_speed())
    for (Table& table : std::vector{speed_table(run), speed_exponent_table(run)}) tables.push_back(std::move(table));
  return tables;
}

}  // namespace zwang::report
