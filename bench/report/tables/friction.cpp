// Friction: one problem under several laws side by side, and which solver shows which phenomenon.

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {
namespace {

// "hand (convex)" is the family hand.
std::string without_law(const std::string& family, const std::string& law) {
  const std::string ending = " (" + law + ")";
  return family.ends_with(ending) ? family.substr(0, family.size() - ending.size()) : family;
}

// One solver on all problems of a family under one law.
struct UnderLaw {
  std::vector<double> error, distance, time;
  std::size_t problems = 0, right = 0, consistent = 0, lies = 0;
};

// 0.38, 2.3, 4e-3
std::string short_number(double value) {
  return value >= 0.01 && value < 100 ? printed("%.2g", value) : scientific(value, 0);
}

Cell phenomenon_cell(const Phenomenon& p) {
  if (!p.applies) return "";
  if (p.passes) return {"ok", p.off, "good"};
  if (!std::isfinite(p.off)) return {"none", unknown, "warn"};
  return {short_number(p.off), p.off, "bad"};
}

}  // namespace

Table law_table(const RunFolder& run) {
  Table table("laws");
  std::set<std::string> compared;  // families that stand under several laws
  for (const Result& r : run.results)
    if (std::isfinite(r.coulomb_error)) compared.insert(without_law(r.family, r.law));
  InOrder<std::tuple<std::string, std::string, std::string>, UnderLaw> rows;
  for (const ProblemRuns& group : group_by_problem(run.results, names(run)))
    for (const std::vector<const Result*>& runs : group.by_solver) {
      const Result* r = tightest(runs);
      if (!r || r->is_blank() || r->law.empty()) continue;
      const std::string family = without_law(r->family, r->law);
      if (!compared.contains(family)) continue;
      UnderLaw& u = rows[{family, r->law, r->solver}];
      ++u.problems;
      u.right += r->is_right();
      u.consistent += r->metrics.verdict == Verdict::consistent;
      u.lies += r->lies();
      const double off = r->law == "coulomb" ? r->metrics.z_error : r->coulomb_error;
      if (std::isfinite(r->metrics.z_error)) u.error.push_back(r->metrics.z_error);
      if (std::isfinite(off)) u.distance.push_back(off);
      if (std::isfinite(r->solve_s)) u.time.push_back(r->solve_s);
    }
  for (const auto& [key, u] : rows.items) {
    const auto& [family, law, solver] = key;
    const double most = u.distance.empty() ? unknown : std::ranges::max(u.distance);
    table.add(solver, family,
              {family, law, solver, count_cell(u.problems),
               part_cell(static_cast<long>(u.right), static_cast<long>(u.problems),
                         tone_of(u.lies > 0, u.right == u.problems)),
               count_cell(u.consistent), count_cell(u.lies, "bad"), number_cell(median(u.error)),
               number_cell(median(u.distance)), number_cell(most), time_cell(median(u.time))});
  }
  table.explain();
  return table;
}

Table conformance_table(const RunFolder& run) {
  Table table("conformance");
  InOrder<std::string, std::vector<const Phenomenon*>> by_solver;
  for (const Phenomenon& p : run.phenomena) {
    by_solver[p.solver].push_back(&p);
    if (std::ranges::find(table.columns, p.check, &Column::name) == table.columns.end())
      table.columns.push_back({p.check, true});
  }
  for (const auto& [solver, all] : by_solver.items) {
    const bool applies = std::ranges::any_of(all, &Phenomenon::applies);
    const auto passed = std::ranges::count_if(all, &Phenomenon::passes);
    std::vector<Cell> cells = {solver, applies ? all.front()->law : "", whole_cell(passed)};
    for (std::size_t c = 3; c < table.columns.size(); ++c) {
      const auto p = std::ranges::find(all, table.columns[c].name, &Phenomenon::check);
      cells.push_back(p == all.end() ? Cell() : phenomenon_cell(**p));
    }
    table.add(solver, "", std::move(cells));
  }
  table.explain();
  return table;
}

Table phenomenon_table(const RunFolder& run) {
  Table table("phenomena");
  for (const Phenomenon& p : run.phenomena)
    if (p.solver == run.phenomena.front().solver) table.add("", "", {p.check, p.expected});
  table.explain();
  return table;
}

}  // namespace zwang::report
