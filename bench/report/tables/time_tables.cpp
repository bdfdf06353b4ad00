// What accuracy costs.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/profile.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {

Table accuracy_table(const Run& run) {
  Table table{"accuracy", "", {{"family"}, {"solver"}}, {}};
  for (const double error : error_levels) table.columns.push_back({"at " + scientific(error, 0), true});
  std::vector<std::string> families = families_of(run.results);
  if (families.size() > 1) families.insert(families.begin(), "");
  for (const std::string& family : families) {
    // Rows stand as at the headline's error; who reaches only looser ones comes after, by the tightest reached.
    std::vector<std::string> order;
    for (const double error : {headline_error, 1e-6, 1e-3})
      for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error))
        if (std::find(order.begin(), order.end(), entry.solver) == order.end()) order.push_back(entry.solver);
    std::map<std::string, std::vector<Cell>> cells;
    for (std::size_t level = 0; level < std::size(error_levels); ++level)
      for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error_levels[level])) {
        auto& row = cells[entry.solver];
        if (row.empty()) row.resize(std::size(error_levels));
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
  table.note =
      table.rows.empty()
          ? "No solver reached 1e-3 on a problem with a reference."
          : "Time to the achieved error, geometric mean over the problems on which it was reached. First come solvers "
            "that reached 1e-9 on the most problems, the fastest of those first; in brackets the ratio to "
            "that error's leader on the problems both reached.";
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
  table.note = table.rows.empty() ? "No solver solved the three largest sizes of a family: there is no exponent to fit."
                                  : "Time grows like size to the power p over the upper half of each sweep, three "
                                    "sizes at least (in logarithms)."
                                    " From three sizes the error is a hint.";
  return table;
}

}  // namespace zwang::report
