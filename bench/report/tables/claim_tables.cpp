// What solvers claim, against what the referee finds.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

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
  if (r.claims_solved() && !std::isfinite(r.primal)) text = "its z holds NaN or infinities";
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

Table claim_counts_table(const Run& run) {
  Table table{"claim-counts",
              "",
              {{"solver"},
               {"false claims", true},
               {"of runs", true},
               {"on problems", true},
               {"worst error", true},
               {"flagged but wrong", true},
               {"infeasible, unproven", true},
               {"families with false claims"}},
              {}};
  struct Count {
    int runs = 0, lies = 0, flagged = 0, unproven = 0;
    const Result* worst = nullptr;
    std::set<std::string> problems = {}, families = {};
  };
  std::map<std::string, Count> counts;
  for (const Result& r : run.results) {
    Count& count = counts[r.solver];
    ++count.runs;
    const int found = gravity(r);
    count.flagged += found == 1;
    count.unproven += found == 2;
    if (found != 0) continue;
    ++count.lies;
    count.problems.insert(r.problem);
    count.families.insert(r.family);
    const auto size = [](const Result* x) { return std::isfinite(x->error()) ? x->error() : -1; };
    if (!count.worst || size(&r) > size(count.worst)) count.worst = &r;
  }
  std::vector<std::string> order = names(run);
  std::erase_if(
      order, [&counts](const std::string& s) { return counts[s].lies + counts[s].flagged + counts[s].unproven == 0; });
  std::stable_sort(order.begin(), order.end(),
                   [&counts](const auto& a, const auto& b) { return counts[a].lies > counts[b].lies; });
  for (const std::string& solver : order) {
    const Count& c = counts[solver];
    std::string families;
    for (const std::string& family : c.families) families += (families.empty() ? "" : ", ") + family;
    table.rows.push_back({solver,
                          "",
                          {{solver},
                           count_cell(c.lies, "bad"),
                           count_cell(c.runs),
                           count_cell(static_cast<int>(c.problems.size())),
                           c.worst ? error_cell(*c.worst) : Cell{},
                           count_cell(c.flagged, "warn"),
                           count_cell(c.unproven, "warn"),
                           {families}},
                          ""});
  }
  table.note =
      table.rows.empty()
          ? "No run made a claim that the referee rejects."
          : "False: the solver claims an answer (or that none exists) and the referee finds it wrong. Flagged "
            "but wrong: it said that its answer may be off, and it is. Solvers that are not listed made no such "
            "claim.";
  return table;
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
    table.rows.push_back(
        {r.solver,
         r.family,
         {{type},
          {r.solver},
          {scientific(w.row->violation) + (w.row->unit.empty() ? "" : " " + w.row->unit), w.row->violation},
          number_cell(w.row->relative),
          {w.row->row},
          {r.problem},
          number_cell(r.tolerance, 0),
          {r.verified, unknown, r.lies() ? "bad" : ""}},
         r.replay});
  }
  table.note = table.rows.empty() ? "No run that claims success violates a row, or the run names none."
                                  : "Among runs that claim success, the worst violated row of each constraint type, in "
                                    "the row's own unit of acceleration (none where no body's constraint made it).";
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
            "replaces c by J k in silence, and z goes wrong by about the gap where the rows so changed are active. An "
            "error far above the gap has another cause.";
  return table;
}

}  // namespace zwang::report
