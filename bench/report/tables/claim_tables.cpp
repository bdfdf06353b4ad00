// What solvers claim, against what the referee finds.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

// Rejected claims, worst first: 0 false, 1 flagged as ill-conditioned but wrong, 2 infeasible without proof.
int gravity(const Result& r) {
  if (r.lies()) return 0;
  if (r.claimed == Status::solved_ill_conditioned && r.metrics.verdict == Verdict::wrong) return 1;
  if (r.metrics.verdict == Verdict::infeasible_claimed) return 2;
  return 3;
}

std::string reason(const Result& r) {
  std::string text;
  if (std::isfinite(r.range_gap) && r.range_gap > 1e-12)
    text = "c leaves range(J): |J k - c|/|c| = " + scientific(r.range_gap);
  if (r.claims_solved() && !std::isfinite(r.metrics.primal)) text = "its z holds NaN or infinities";
  if (r.feasible == std::optional(false) && r.claims_solved()) text = "the rows are inconsistent";
  if (r.feasible == std::optional(true) && r.claimed == Status::infeasible) text = "the rows are consistent";
  if (text.empty() && !r.worst_row.empty() && std::isfinite(r.metrics.primal))
    text = "worst row " + r.worst_row + ", violation " + scientific(r.metrics.primal) + " of the scale";
  return text;
}

std::string tolerance_range(const std::set<double>& tolerances) {
  const std::string low = scientific(*tolerances.begin(), 0), high = scientific(*tolerances.rbegin(), 0);
  return tolerances.size() == 1 ? low : high + " to " + low;
}

}  // namespace

Table claim_counts_table(const RunFolder& run) {
  Table table("claim-counts");
  struct Count {
    std::size_t runs = 0, lies = 0, flagged = 0, unproven = 0;
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
  std::ranges::stable_sort(order, std::greater(), [&](const std::string& solver) { return counts[solver].lies; });
  for (const std::string& solver : order) {
    const Count& c = counts[solver];
    if (c.lies + c.flagged + c.unproven == 0) continue;
    table.add(solver, "",
              {solver, count_cell(c.lies, "bad"), count_cell(c.runs), count_cell(c.problems.size()),
               c.worst ? error_cell(*c.worst) : Cell(), count_cell(c.flagged, "warn"), count_cell(c.unproven, "warn"),
               joined({c.families.begin(), c.families.end()})});
  }
  table.explain();
  return table;
}

Table claims_table(const RunFolder& run) {
  Table table("claims");
  struct Group {
    const Result* worst;
    std::set<double> tolerances = {};
    int runs = 0;
  };
  std::map<std::array<std::string, 4>, Group> groups;
  for (const Result& r : run.results) {
    if (gravity(r) > 2) continue;
    Group& group = groups.try_emplace({r.solver, r.problem, r.claim(), r.verdict()}, Group{&r}).first->second;
    group.tolerances.insert(r.tolerance);
    ++group.runs;
    if (r.metrics.z_error > group.worst->metrics.z_error) group.worst = &r;
  }
  // The worst kind first; within a kind answers where none exists, then by error, largest first.
  std::vector<Group> sorted;
  for (const auto& [key, group] : groups) sorted.push_back(group);
  std::ranges::sort(sorted, {}, [](const Group& g) {
    return std::tuple(gravity(*g.worst),
                      std::isfinite(g.worst->metrics.z_error) ? -g.worst->metrics.z_error : -INFINITY, g.worst);
  });
  for (const Group& group : sorted) {
    const Result& r = *group.worst;
    const std::string tone = r.lies() ? "bad" : "warn";
    table.add(r.solver, r.family,
              {r.solver, r.problem, Cell(tolerance_range(group.tolerances), *group.tolerances.begin()),
               whole_cell(group.runs), Cell(r.claim(), unknown, tone), Cell(r.verdict(), unknown, tone), error_cell(r),
               reason(r)},
              replay_of(run, r));
  }
  const bool lies = std::ranges::any_of(run.results, &Result::lies);
  table.explain(lies ? "rows" : "no lies");
  return table;
}

Table recorded_table(const RunFolder& run) {
  Table table("recorded");
  InOrder<std::pair<std::string, std::string>, std::vector<const Result*>> groups;
  for (const Result& r : run.recorded) groups[{r.family, r.solver}].push_back(&r);
  for (const auto& [key, answers] : groups.items) {
    std::vector<double> errors;
    long right = 0, near = 0, wrong = 0;
    for (const Result* r : answers) {
      if (std::isfinite(r->metrics.z_error)) errors.push_back(r->metrics.z_error);
      right += r->is_right();
      near += r->metrics.verdict == Verdict::near;
      wrong += r->metrics.verdict == Verdict::wrong;
    }
    std::ranges::sort(errors);
    const double none = unknown;
    table.add(
        "", key.first,
        {key.first, key.second, whole_cell(std::ssize(answers)), whole_cell(right), whole_cell(near), whole_cell(wrong),
         whole_cell(std::ssize(answers) - right - near - wrong), number_cell(errors.empty() ? none : errors.front()),
         number_cell(median(errors)), number_cell(errors.empty() ? none : errors.back())});
  }
  const double asked = run.recorded.empty() ? unknown : run.recorded.front().tolerance;
  table.explain();
  if (const auto at = table.note.find('@'); at != std::string::npos) table.note.replace(at, 1, scientific(asked, 0));
  return table;
}

Table verdict_table(const RunFolder& run) {
  Table table("verdicts");
  std::vector<Verdict> columns;
  for (const Verdict verdict :
       {Verdict::solved, Verdict::near, Verdict::wrong, Verdict::infeasible_proven, Verdict::infeasible_claimed,
        Verdict::undecided, Verdict::consistent, Verdict::rows_off, Verdict::no_answer, Verdict::timeout,
        Verdict::crashed, Verdict::bad_input, Verdict::unsupported})
    if (std::ranges::any_of(run.results, [verdict](const Result& r) { return r.metrics.verdict == verdict; })) {
      columns.push_back(verdict);
      table.columns.push_back({std::string(to_string(verdict)), true});
    }
  table.add_columns("#fallback used");
  struct Count {
    Result probe = {};  // of this claim
    std::map<Verdict, std::size_t> runs = {};
    std::size_t fallbacks = 0;
  };
  std::map<std::pair<std::string, std::string>, Count> counts;  // by solver and claim
  for (const Result& r : run.results) {
    Count& count = counts[{r.solver, r.claim()}];
    count.probe.claimed = r.claimed;
    ++count.runs[r.metrics.verdict];
    count.fallbacks += r.fallback;
  }
  for (const std::string& solver : names(run))
    for (auto& [key, count] : counts) {
      if (key.first != solver) continue;
      std::vector<Cell> cells = {solver, key.second};
      Result& probe = count.probe;
      for (const Verdict verdict : columns) {
        probe.metrics.verdict = verdict;
        const bool flagged = verdict == Verdict::wrong && !probe.lies();
        cells.push_back(count_cell(count.runs[verdict], flagged ? "warn" : tone_of(probe.lies(), probe.is_right())));
      }
      cells.push_back(count_cell(count.fallbacks));
      table.add(solver, "", std::move(cells));
    }
  table.explain();
  return table;
}

Table worst_row_table(const RunFolder& run) {
  Table table("worst-rows");
  using Worst = std::pair<const Result::WorstRow*, const Result*>;
  std::map<std::pair<std::string, std::string>, Worst> worst;
  for (const Result& r : run.results) {
    if (!r.claims_solved()) continue;
    for (const Result::WorstRow& row : r.worst_by_type) {
      if (!std::isfinite(row.relative) || row.relative <= 0) continue;
      Worst& found = worst.try_emplace({row.type, r.solver}, &row, &r).first->second;
      if (row.relative > found.first->relative) found = {&row, &r};
    }
  }
  std::vector<Worst> sorted;
  for (const auto& [key, found] : worst) sorted.push_back(found);
  std::ranges::sort(sorted, {}, [](const Worst& w) { return std::tuple(w.first->type, -w.first->relative, w.second); });
  for (const auto& [row, result] : sorted) {
    const Result& r = *result;
    table.add(r.solver, r.family,
              {row->type, r.solver,
               Cell(scientific(row->violation) + (row->unit.empty() ? "" : " " + row->unit), row->violation),
               number_cell(row->relative), row->name, r.problem, number_cell(r.tolerance, 0),
               Cell(r.verdict(), unknown, tone_of(r.lies(), false))},
              replay_of(run, r));
  }
  table.explain();
  return table;
}

Table range_gap_table(const RunFolder& run) {
  Table table("range-gap");
  InOrder<std::pair<std::string, std::string>, const Result*> tightest;
  for (const Result& r : run.results) {
    if (!std::isfinite(r.range_gap)) continue;
    const Result*& kept = tightest[{r.solver, r.problem}];
    if (!kept || r.tolerance < kept->tolerance) kept = &r;
  }
  for (const auto& [key, kept] : tightest.items) {
    const Result& r = *kept;
    table.add(r.solver, r.family,
              {r.problem, whole_cell(r.m), knob_cell(r.knob_value), number_cell(r.range_gap), error_cell(r), r.claim(),
               Cell(r.verdict(), unknown, tone_of(r.lies(), r.metrics.verdict == Verdict::solved))},
              replay_of(run, r));
  }
  table.explain();
  return table;
}

}  // namespace zwang::report
