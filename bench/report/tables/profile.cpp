#include <zwang/bench/report/tables/profile.h>

#include <algorithm>
#include <cmath>

#include <zwang/bench/report/tables/statistics.h>

namespace zwang::report {
namespace {

// A staircase through the sorted values, one step for equal ones.
Curve staircase(std::vector<double> values, std::size_t problems) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  Curve curve;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(problems);
    if (!curve.empty() && curve.back().at == values[i])
      curve.back().share = share;
    else
      curve.push_back({values[i], share});
  }
  return curve;
}

std::size_t solvers_in(const Times& times) { return times.empty() ? 0 : times.front().size(); }

double fastest(const std::vector<double>& row) { return *std::min_element(row.begin(), row.end()); }

}  // namespace

Times times_to_error(const std::vector<ProblemRuns>& groups, const std::string& family, double error) {
  Times times;
  for (const ProblemRuns& group : groups) {
    if (!family.empty() && group.family != family) continue;
    std::vector<double>& row = times.emplace_back();
    for (const auto& runs : group.by_solver) row.push_back(time_to_error(runs, error));
  }
  return times;
}

std::vector<Curve> performance_profile(const Times& times) {
  std::vector<Curve> curves;
  for (std::size_t s = 0; s < solvers_in(times); ++s) {
    std::vector<double> ratios;
    for (const auto& row : times)
      if (std::isfinite(row[s])) ratios.push_back(row[s] / fastest(row));
    curves.push_back(staircase(ratios, times.size()));
  }
  return curves;
}

std::vector<Curve> data_profile(const Times& times) {
  std::vector<Curve> curves;
  for (std::size_t s = 0; s < solvers_in(times); ++s) {
    std::vector<double> column;
    for (const auto& row : times) column.push_back(row[s]);
    curves.push_back(staircase(column, times.size()));
  }
  return curves;
}

std::vector<double> shifted_geometric_means(const Times& times, double shift, double penalty) {
  std::vector<double> means;
  for (std::size_t s = 0; s < solvers_in(times); ++s) {
    std::vector<double> column;
    for (const auto& row : times) {
      double slowest = 0;
      for (const double t : row)
        if (std::isfinite(t)) slowest = std::max(slowest, t);
      if (slowest > 0) column.push_back(std::isfinite(row[s]) ? row[s] : penalty * slowest);
    }
    means.push_back(geometric_mean(column, shift));
  }
  return means;
}

double natural_shift(const Times& times) {
  std::vector<double> all;
  for (const auto& row : times)
    for (const double t : row)
      if (std::isfinite(t)) all.push_back(t);
  const double middle = median(all);
  if (!(middle > 0)) return 0;
  const double decade = std::pow(10, std::floor(std::log10(middle)));
  return std::round(middle / decade) * decade;
}

}  // namespace zwang::report
