#include "experiments/report/tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

#include "experiments/report/accuracy.h"
#include "experiments/report/profile.h"
#include "experiments/report/sweeps.h"

namespace zwang::report {
namespace {

std::vector<std::string> names(const Run& run) {
  std::vector<std::string> out;
  for (const SolverInfo& s : run.solvers) out.push_back(s.name);
  return out;
}

Cell count_cell(int n, std::string tone = "") {
  return {n == 0 ? "" : std::to_string(n), static_cast<double>(n), n == 0 ? "" : std::move(tone)};
}

Cell number_cell(double value, int digits = 1) { return {scientific(value, digits), value}; }

// The error the referee measured, or the bound that stands in for it.
Cell error_cell(const Result& r) {
  if (std::isfinite(r.z_error)) return number_cell(r.z_error);
  if (std::isfinite(r.z_bound)) return {"<= " + scientific(r.z_bound), r.z_bound};
  return {r.feasible == std::optional(false) ? "no z exists" : "no reference", unknown};
}

// Rows are accelerations J z - c: of a point, of an angle, or of both in the joints that lock both.
std::string row_unit(const std::string& type) {
  const auto has = [&type](const char* part) { return type.find(part) != std::string::npos; };
  if (has("limit")) return "rad/s^2";
  if (has("contact") || has("ball") || has("distance") || has("rope") || has("friction") || has("ground"))
    return "m/s^2";
  if (has("revolute") || has("universal") || has("weld") || has("prismatic") || has("hinge") || has("coupling"))
    return "m/s^2 or rad/s^2";
  return "(row's unit)";
}

// Rejected claims, gravest first: 0 lies, 1 flagged as ill-conditioned but wrong, 2 infeasible without proof.
int gravity(const Result& r) {
  if (r.lies()) return 0;
  if (r.claimed == "solved, ill-conditioned" && r.verified == "wrong") return 1;
  if (r.verified == "infeasible, claimed only") return 2;
  return 3;
}

std::string reason(const Result& r) {
  std::string text;
  if (std::isfinite(r.range_gap) && r.range_gap > 1e-12)
    text = "c leaves range(J): |J k - c|/|c| = " + scientific(r.range_gap);
  if (r.feasible == std::optional(false) && r.claims_solved()) text = "the rows are inconsistent";
  if (r.feasible == std::optional(true) && r.claimed == "infeasible") text = "the rows are consistent";
  if (text.empty() && !r.worst_row.empty() && std::isfinite(r.primal))
    text = "worst row " + r.worst_row + ", violation " + scientific(r.primal) + " of the scale";
  return text;
}

std::string tolerance_range(const std::set<double>& tolerances) {
  const std::string low = scientific(*tolerances.begin(), 0), high = scientific(*tolerances.rbegin(), 0);
  return tolerances.size() == 1 ? low : high + " to " + low;
}

}  // namespace

std::string knob_text(double value) {
  if (!std::isfinite(value)) return "";
  int exponent = 0;
  if (const double mantissa = std::frexp(std::abs(value), &exponent);
      mantissa == 0.5 && (exponent < -2 || exponent > 10))
    return std::string(value < 0 ? "-" : "") + "2^" + std::to_string(exponent - 1);
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

Table claims_table(const Run& run) {
  Table table{"claims", "", {}, {}};
  table.columns = {{"solver"},  {"problem"},  {"tolerances asked"},  {"runs", true},
                   {"claimed"}, {"verified"}, {"worst error", true}, {"why"}};
  struct Group {
    const Result* worst;
    std::set<double> tolerances;
    int runs = 0;
  };
  std::map<std::array<std::string, 4>, std::size_t> index;
  std::vector<Group> groups;
  for (const Result& r : run.results) {
    if (gravity(r) > 2) continue;
    const auto [it, fresh] = index.try_emplace({r.solver, r.problem, r.claimed, r.verified}, groups.size());
    if (fresh) groups.push_back({&r, {}, 0});
    Group& group = groups[it->second];
    group.tolerances.insert(r.tolerance);
    ++group.runs;
    if (r.z_error > group.worst->z_error) group.worst = &r;
  }
  // The gravest first; among them the largest error, and before all errors an answer where none exists.
  const auto rank = [](const Group& g) {
    return std::tuple(gravity(*g.worst), std::isfinite(g.worst->z_error) ? -g.worst->z_error : -INFINITY, g.worst);
  };
  std::sort(groups.begin(), groups.end(), [rank](const Group& a, const Group& b) { return rank(a) < rank(b); });
  int lies = 0;
  for (const Group& group : groups) {
    const Result& r = *group.worst;
    const std::string tone = gravity(r) == 0 ? "bad" : "warn";
    if (r.lies()) lies += group.runs;
    table.rows.push_back({r.solver,
                          r.family,
                          {{r.solver},
                           {r.problem},
                           {tolerance_range(group.tolerances), *group.tolerances.begin()},
                           {std::to_string(group.runs), static_cast<double>(group.runs)},
                           {r.claimed, unknown, tone},
                           {r.verified, unknown, tone},
                           error_cell(r),
                           {reason(r)}},
                          r.replay});
  }
  table.note = table.rows.empty() ? "No run made a claim that the referee rejects."
               : lies == 0 ? "No run claimed success, or infeasibility, where the referee found the opposite. Flagged "
                             "or unproven claims:"
                           : "Runs that claimed an answer and were wrong come first; below them claims flagged as "
                             "ill-conditioned and claims of infeasibility without proof.";
  return table;
}

Table accuracy_table(const Run& run) {
  Table table{"accuracy", "", {{"family"}, {"solver"}}, {}};
  for (const double error : error_levels) table.columns.push_back({"at " + scientific(error, 0), true});
  std::vector<std::string> families = families_of(run.results);
  if (families.size() > 1) families.insert(families.begin(), "");
  for (const std::string& family : families) {
    std::vector<std::string> order;
    std::map<std::string, std::vector<Cell>> cells;
    for (std::size_t level = 0; level < std::size(error_levels); ++level)
      for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error_levels[level])) {
        auto& row = cells[entry.solver];
        if (row.empty()) row.resize(std::size(error_levels)), order.push_back(entry.solver);
        std::string text = duration(entry.time_s) + " (" + ratio_text(entry.ratio) + ")";
        if (entry.reached < entry.problems)
          text += " on " + std::to_string(entry.reached) + " of " + std::to_string(entry.problems);
        row[level] = {text, entry.time_s, entry.ratio == 1 && entry.reached == entry.problems ? "good" : ""};
      }
    const std::string shown = family.empty() ? "all" : family;
    for (const std::string& solver : order) {
      Row row{solver, shown, {{shown}, {solver}}, ""};
      for (Cell& cell : cells[solver]) row.cells.push_back(cell.text.empty() ? Cell{"not reached"} : cell);
      table.rows.push_back(row);
    }
  }
  table.note = table.rows.empty()
                   ? "No solver reached 1e-3 on a problem with a reference."
                   : "Time to the achieved error, geometric mean over the problems on which it was reached; "
                     "in brackets the ratio to the leading solver on the problems both reached.";
  return table;
}

Table means_table(const Run& run) {
  constexpr double penalty = 10;
  Table table{"means", "", {{"solver"}}, {}};
  const auto solvers = names(run);
  const auto groups = group_by_problem(run.results, solvers);
  table.rows.resize(solvers.size());
  for (std::size_t s = 0; s < solvers.size(); ++s) table.rows[s] = {solvers[s], "", {{solvers[s]}}, ""};
  for (const double error : {1e-6, 1e-12}) {
    const Times times = times_to_error(groups, "", error);
    const double near = natural_shift(times);
    if (near == 0) continue;
    table.columns.push_back({"solved at " + scientific(error, 0), true});
    for (const double shift : {near, 10 * near})
      table.columns.push_back({"mean at " + scientific(error, 0) + ", shift " + duration(shift), true});
    std::array<std::vector<double>, 2> means = {shifted_geometric_means(times, near, penalty),
                                                shifted_geometric_means(times, 10 * near, penalty)};
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      const auto solved =
          std::count_if(times.begin(), times.end(), [s](const auto& row) { return std::isfinite(row[s]); });
      table.rows[s].cells.push_back(
          {std::to_string(solved) + " of " + std::to_string(times.size()), static_cast<double>(solved)});
      for (const auto& mean : means) table.rows[s].cells.push_back({duration(mean[s]), mean[s]});
    }
  }
  if (table.columns.size() == 1) table.rows.clear();
  table.note =
      table.rows.empty()
          ? "No solver reached 1e-3 on a problem with a reference."
          : "Shifted geometric mean of the time over all problems that somebody solved; a failure counts as 10 times "
            "the slowest success on that problem.";
  return table;
}

Table break_point_table(const Run& run) {
  Table table{"break-points", "", {{"solver"}}, {}};
  std::vector<std::string> families;
  std::map<std::string, std::map<std::string, BreakPoint>> found;
  for (const BreakPoint& point : break_points(run.results, names(run))) {
    if (std::find(families.begin(), families.end(), point.family) == families.end()) {
      families.push_back(point.family);
      table.columns.push_back({point.family + (point.knob.empty() ? "" : " (" + point.knob + ")")});
    }
    found[point.solver][point.family] = point;
  }
  for (const std::string& solver : names(run)) {
    if (!found.contains(solver)) continue;
    Row row{solver, "", {{solver}}, ""};
    for (const std::string& family : families) {
      const auto it = found[solver].find(family);
      if (it == found[solver].end() || it->second.problems == 0) {
        row.cells.push_back({"unsupported"});
        continue;
      }
      const BreakPoint& p = it->second;
      const auto at = [](const Result* r) {
        return r ? (std::isfinite(r->knob_value) ? knob_text(r->knob_value) : r->problem) : "never";
      };
      Cell cell{at(p.fails) + " / " + at(p.lies), p.fails ? p.fails->knob_value : unknown,
                p.lies    ? "bad"
                : p.fails ? "warn"
                          : "good"};
      if (p.undecided) cell.text += " (" + std::to_string(p.undecided) + " undecided)";
      row.cells.push_back(cell);
    }
    table.rows.push_back(row);
  }
  table.note =
      table.rows.empty()
          ? "This run holds none of the stability families MR, NPE, LOOP, GAP, INC, WEAK."
          : "First knob value, from benign to hard, where z fails / where the status lies, each solver at its tightest "
            "tolerance. Fails: error above 1e-6, no answer, or a wrong word on feasibility. Lies: claims to be right "
            "there.";
  return table;
}

Table exponent_table(const Run& run) {
  Table table{"exponents",
              "",
              {{"family"}, {"solver"}, {"size"}, {"from", true}, {"to", true}, {"exponent p", true}, {"2 s.e.", true}},
              {}};
  for (const Scaling& family : scaling(run.results, names(run), 1e-6))
    for (const ScalingFit& fit : family.fits) {
      char p[32], error[32];
      std::snprintf(p, sizeof p, "%.2f", fit.law.exponent);
      std::snprintf(error, sizeof error, "%.2f", 2 * fit.law.error);
      table.rows.push_back({fit.solver,
                            family.family,
                            {{family.family},
                             {fit.solver},
                             {family.axis},
                             {knob_text(fit.from), fit.from},
                             {knob_text(fit.to), fit.to},
                             {p, fit.law.exponent},
                             {error, 2 * fit.law.error}},
                            ""});
    }
  table.note = table.rows.empty()
                   ? "No family of this run has three sizes in the upper half of its range to fit an exponent to."
                   : "Time grows like size to the power p over the upper half of each sweep (in logarithms).";
  return table;
}

Table verdict_table(const Run& run) {
  constexpr std::array<const char*, 11> order = {
      "solved",  "near",    "wrong",     "infeasible, proven", "infeasible, claimed only", "undecided", "no answer",
      "timeout", "crashed", "bad input", "unsupported"};
  Table table{"verdicts",
              "Runs by what the solver claims (rows) and what the referee finds (columns). Red: claims that are false.",
              {{"solver"}, {"claimed"}},
              {}};
  std::vector<std::string> columns;
  for (const char* verdict : order)
    if (std::any_of(run.results.begin(), run.results.end(),
                    [verdict](const Result& r) { return r.verified == verdict; }))
      columns.push_back(verdict), table.columns.push_back({verdict, true});
  table.columns.push_back({"fallback used", true});
  std::map<std::pair<std::string, std::string>, std::map<std::string, int>> counts;
  std::map<std::pair<std::string, std::string>, int> fallbacks;
  for (const Result& r : run.results) {
    ++counts[{r.solver, r.claimed}][r.verified];
    fallbacks[{r.solver, r.claimed}] += r.fallback;
  }
  for (const std::string& solver : names(run))
    for (auto& [key, row_counts] : counts) {
      if (key.first != solver) continue;
      Row row{solver, "", {{solver}, {key.second}}, ""};
      for (const std::string& verdict : columns) {
        const Result probe{.claimed = key.second, .verified = verdict};
        const bool right = verdict == "solved" || verdict == "infeasible, proven";
        row.cells.push_back(count_cell(row_counts[verdict], probe.lies()         ? "bad"
                                                            : verdict == "wrong" ? "warn"
                                                            : right              ? "good"
                                                                                 : ""));
      }
      row.cells.push_back(count_cell(fallbacks[key]));
      table.rows.push_back(row);
    }
  if (table.rows.empty()) table.note = "The run holds no results.";
  return table;
}

Table worst_row_table(const Run& run) {
  Table table{"worst-rows",
              "",
              {{"constraint type"},
               {"solver"},
               {"violation", true},
               {"of the scale", true},
               {"row"},
               {"problem"},
               {"tolerance", true},
               {"verified"}},
              {}};
  struct Worst {
    const WorstRow* row;
    const Result* result;
  };
  std::map<std::pair<std::string, std::string>, Worst> worst;
  for (const Result& r : run.results) {
    if (!r.claims_solved()) continue;
    for (const WorstRow& row : r.worst_by_type) {
      if (!std::isfinite(row.relative) || row.relative <= 0) continue;
      const auto [it, fresh] = worst.try_emplace({row.type, r.solver}, Worst{&row, &r});
      if (!fresh && row.relative > it->second.row->relative) it->second = {&row, &r};
    }
  }
  std::vector<std::pair<std::string, Worst>> sorted;
  for (const auto& [key, w] : worst) sorted.emplace_back(key.first, w);
  const auto rank = [](const auto& entry) {
    return std::tuple(entry.first, -entry.second.row->relative, entry.second.result);
  };
  std::sort(sorted.begin(), sorted.end(), [rank](const auto& a, const auto& b) { return rank(a) < rank(b); });
  for (const auto& [type, w] : sorted) {
    const Result& r = *w.result;
    table.rows.push_back({r.solver,
                          r.family,
                          {{type},
                           {r.solver},
                           {scientific(w.row->violation) + " " + row_unit(type), w.row->violation},
                           number_cell(w.row->relative),
                           {w.row->row},
                           {r.problem},
                           number_cell(r.tolerance, 0),
                           {r.verified, unknown, r.lies() ? "bad" : ""}},
                          r.replay});
  }
  table.note = table.rows.empty() ? "No run that claims success violates a row, or the run names none."
                                  : "Among runs that claim success, the worst violated row of each constraint type, in "
                                    "the row's own unit of acceleration.";
  return table;
}

Table range_gap_table(const Run& run) {
  Table table{"range-gap",
              "",
              {{"problem"},
               {"rows m", true},
               {"knob", true},
               {"range gap |J k - c|/|c|", true},
               {"error", true},
               {"claimed"},
               {"verified"}},
              {}};
  std::map<std::pair<std::string, std::string>, const Result*> tight;
  std::vector<std::pair<std::string, std::string>> order;
  for (const Result& r : run.results) {
    if (!std::isfinite(r.range_gap)) continue;
    const auto [it, fresh] = tight.try_emplace({r.solver, r.problem}, &r);
    if (fresh) order.emplace_back(r.solver, r.problem);
    if (r.tolerance < it->second->tolerance) it->second = &r;
  }
  for (const auto& key : order) {
    const Result& r = *tight[key];
    table.rows.push_back({r.solver,
                          r.family,
                          {{r.problem},
                           {std::to_string(r.m), static_cast<double>(r.m)},
                           {knob_text(r.knob_value), r.knob_value},
                           number_cell(r.range_gap),
                           error_cell(r),
                           {r.claimed},
                           {r.verified, unknown,
                            r.lies()                 ? "bad"
                            : r.verified == "solved" ? "good"
                                                     : ""}},
                          r.replay});
  }
  table.note =
      table.rows.empty()
          ? "No solver of this run reports a range gap (nnls_paper does)."
          : "nnls_paper needs a k with J k = c. Where c lies outside the range of J there is none: least squares "
            "replaces c by J k in silence, and z is wrong by about the gap.";
  return table;
}

Table reference_table(const Run& run) {
  Table table{"references",
              "What the referee's truth rests on.",
              {{"family"}, {"problems", true}, {"reference"}, {"infeasible", true}},
              {}};
  std::vector<std::string> families = families_of(run.results);
  for (const std::string& family : families) {
    std::map<std::string, std::set<std::string>> by_reference;
    std::set<std::string> problems, infeasible;
    for (const Result& r : run.results) {
      if (r.family != family) continue;
      problems.insert(r.problem);
      by_reference[r.reference.empty() ? "none (bound only)" : r.reference].insert(r.problem);
      if (r.feasible == std::optional(false)) infeasible.insert(r.problem);
    }
    std::string text;
    for (const auto& [name, which] : by_reference)
      text += (text.empty() ? "" : "; ") + name + (by_reference.size() > 1 ? ": " + std::to_string(which.size()) : "");
    table.rows.push_back({"",
                          family,
                          {{family},
                           {std::to_string(problems.size()), static_cast<double>(problems.size())},
                           {text},
                           count_cell(static_cast<int>(infeasible.size()))},
                          ""});
  }
  if (table.rows.empty()) table.note = "The run holds no results.";
  return table;
}

Table solver_table(const Run& run) {
  Table table{"solvers", "", {{"solver"}, {"method"}, {"limits"}, {"runs in"}}, {}};
  for (const SolverInfo& s : run.solvers)
    table.rows.push_back(
        {s.name, "", {{s.name}, {s.method}, {s.limits}, {s.foreign ? "a child process" : "this process"}}, ""});
  if (table.rows.empty()) table.note = "No solver has run yet.";
  return table;
}

Table conditions_table(const Run& run) {
  Table table{"conditions", "", {{"condition"}, {"value"}}, {}};
  for (const auto& [name, value] : run.conditions) table.rows.push_back({"", "", {{name}, {value}}, ""});
  if (table.rows.empty()) table.note = "The run has no run.json: its circumstances are unknown.";
  return table;
}

std::vector<Table> all_tables(const Run& run) {
  return {claims_table(run),    accuracy_table(run), means_table(run),     break_point_table(run),
          exponent_table(run),  verdict_table(run),  worst_row_table(run), range_gap_table(run),
          reference_table(run), solver_table(run),   conditions_table(run)};
}

}  // namespace zwang::report
