#include <zwang/bench/report/tables/profile.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/bench/report/tables/statistics.h>

namespace zwang::report {
namespace {

// A staircase through the sorted values, one step for equal ones.
Curve staircase(std::vector<double> values) {
  const auto problems = std::ranges::count_if(values, [](double v) { return !std::isnan(v); });
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

// `cost`: of a solver's time on one problem, given all times on it.
template <class Cost>
std::vector<Curve> curves(const Times& times, Cost cost) {
  std::vector<Curve> all;
  for (std::size_t s = 0; s < solvers_in(times); ++s) {
    std::vector<double> costs;
    for (const auto& row : times) costs.push_back(cost(row[s], row));
    all.push_back(staircase(costs));
  }
  return all;
}

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
  return curves(times, [](double time, const auto& row) {
    double fastest = std::numeric_limits<double>::infinity();
    for (const double t : row) fastest = std::fmin(fastest, t);
    return std::isinf(time) ? time : time / fastest;
  });
}

std::vector<Curve> data_profile(const Times& times) {
  return curves(times, [](double time, const auto&) { return time; });
}

std::vector<double> shifted_geometric_means(const Times& times, double shift, double penalty) {
  std::vector<double> means;
  for (std::size_t s = 0; s < solvers_in(times); ++s) {
    std::vector<double> column;
    for (const auto& row : times) {
      double slowest = 0;
      for (const double t : row)
        if (std::isfinite(t)) slowest = std::max(slowest, t);
      if (slowest > 0 && !std::isnan(row[s])) column.push_back(std::isfinite(row[s]) ? row[s] : penalty * slowest);
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
