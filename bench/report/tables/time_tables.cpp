// What accuracy costs.

#include <algorithm>
#include <cmath>
#include <iterator>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/tables/profile.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {

Table accuracy_table(const RunFolder& run) {
  Table table("accuracy");
  for (const double error : error_levels) table.columns.push_back({"at " + scientific(error, 0), true});
  std::vector<std::string> families = families_of(run.results);
  if (families.size() > 1) families.insert(families.begin(), "");
  for (const std::string& family : families) {
    const std::string shown = family.empty() ? "all" : family;
    // Ordered as at the headline's error; solvers that reach only looser ones follow, by the tightest they reach.
    InOrder<std::string, std::vector<Cell>> rows;
    for (const double error : {headline_error, 1e-6, 1e-3})
      for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error))
        rows[entry.solver] = {shown, entry.solver};
    for (auto& [solver, cells] : rows.items) cells.resize(2 + std::size(error_levels), "not reached");
    for (std::size_t level = 0; level < std::size(error_levels); ++level)
      for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error_levels[level])) {
        const bool everywhere = entry.reached == entry.problems;
        std::string text = duration(entry.time_s) + " (" + ratio_text(entry.ratio) + ")";
        if (!everywhere) text += " on " + part_of(entry.reached, entry.reads);
        rows[entry.solver][2 + level] = {text, entry.time_s, tone_of(false, entry.ratio == 1 && everywhere)};
      }
    for (auto& [solver, cells] : rows.items) table.add(solver, shown, std::move(cells));
  }
  table.explain();
  return table;
}

Table means_table(const RunFolder& run) {
  constexpr double penalty = 10;
  Table table("means");
  const auto solvers = names(run);
  const auto groups = group_by_problem(run.results, solvers);
  for (const std::string& solver : solvers) table.add(solver, "", {solver});
  for (const double error : {1e-6, 1e-12}) {
    const Times times = times_to_error(groups, "", error);
    const double near = natural_shift(times);
    if (near == 0) continue;
    table.columns.push_back({"solved at " + scientific(error, 0), true});
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      const auto solved = std::ranges::count_if(times, [s](const auto& row) { return std::isfinite(row[s]); });
      const auto read = std::ranges::count_if(times, [s](const auto& row) { return !std::isnan(row[s]); });
      table.rows[s].cells.push_back(part_cell(solved, read));
    }
    for (const double shift : {near, 10 * near}) {
      table.columns.push_back({"mean at " + scientific(error, 0) + ", shift " + duration(shift), true});
      const std::vector<double> means = shifted_geometric_means(times, shift, penalty);
      for (std::size_t s = 0; s < solvers.size(); ++s) table.rows[s].cells.push_back(time_cell(means[s]));
    }
  }
  if (table.columns.size() == 1) table.rows.clear();
  table.explain();
  return table;
}

Table exponent_table(const RunFolder& run) {
  Table table("exponents");
  for (const Scaling& family : scaling(run.results, names(run), 1e-6))
    for (const ScalingFit& fit : family.fits)
      table.add(fit.solver, family.family,
                {family.family, fit.solver, family.axis, knob_cell(fit.from), knob_cell(fit.to),
                 fixed_cell(fit.law.exponent, 2), fixed_cell(2 * fit.law.error, 2)});
  table.explain();
  return table;
}

}  // namespace zwang::report
