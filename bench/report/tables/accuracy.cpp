#include <zwang/bench/report/tables/accuracy.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::vector<ProblemRuns> group_by_problem(const std::vector<Result>& results, const std::vector<std::string>& solvers) {
  InOrder<std::string, ProblemRuns> groups;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < solvers.size(); ++i) index[solvers[i]] = i;
  for (const Result& r : results) {
    ProblemRuns& group = groups[r.problem];
    if (group.problem.empty()) group = {r.problem, r.family, {solvers.size(), std::vector<const Result*>()}};
    if (const auto s = index.find(r.solver); s != index.end()) group.by_solver[s->second].push_back(&r);
  }
  std::vector<ProblemRuns> all;
  for (auto& [problem, group] : groups.items) all.push_back(std::move(group));
  return all;
}

double time_to_error(const std::vector<const Result*>& runs, double error) {
  constexpr double floor = 1e-17;  // an error of 0 has a logarithm here
  if (std::ranges::all_of(runs, &Result::is_blank)) return unknown;
  double best = infinite;
  std::vector<const Result*> ladder;
  for (const Result* r : runs) {
    if (r->lies() || !std::isfinite(r->solve_s)) continue;
    if (r->metrics.verdict == Verdict::infeasible_proven) best = std::min(best, r->solve_s);
    if (std::isfinite(r->error())) ladder.push_back(r);
  }
  std::sort(ladder.begin(), ladder.end(), [](auto* a, auto* b) { return a->tolerance > b->tolerance; });
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    const Result& r = *ladder[i];
    if (r.error() <= error) best = std::min(best, r.solve_s);
    if (i == 0) continue;
    const Result& before = *ladder[i - 1];
    if (r.error() > error || before.error() <= error) continue;
    const double e0 = std::log(std::max(before.error(), floor)), e1 = std::log(std::max(r.error(), floor));
    const double share = (std::log(error) - e0) / (e1 - e0);
    best = std::min(best, std::exp(std::lerp(std::log(before.solve_s), std::log(r.solve_s), share)));
  }
  return best;
}

std::vector<AccuracyMatched> accuracy_matched(const std::vector<Result>& results, const std::string& family,
                                              double error) {
  const std::vector<std::string> solvers = solvers_of(results);
  std::vector<std::vector<double>> time(solvers.size());  // [solver][problem]
  for (const ProblemRuns& group : group_by_problem(results, solvers)) {
    if (!family.empty() && group.family != family) continue;
    for (std::size_t s = 0; s < solvers.size(); ++s) time[s].push_back(time_to_error(group.by_solver[s], error));
  }
  std::vector<std::tuple<int, double, std::size_t>> order;  // fewest misses, then fastest
  std::vector<AccuracyMatched> table;
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    std::vector<double> reached = time[s];
    std::erase_if(reached, [](double t) { return !std::isfinite(t); });
    if (reached.empty()) continue;
    order.emplace_back(-static_cast<int>(reached.size()), geometric_mean(reached), s);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [misses, mean, s] : order) {
    const std::vector<double>& leader = time[std::get<2>(order.front())];
    std::vector<double> ratios;
    for (std::size_t p = 0; p < leader.size(); ++p)
      if (std::isfinite(time[s][p]) && std::isfinite(leader[p])) ratios.push_back(time[s][p] / leader[p]);
    const auto read = std::ranges::count_if(time[s], [](double t) { return !std::isnan(t); });
    table.push_back(
        {solvers[s], mean, geometric_mean(ratios), -misses, static_cast<int>(read), static_cast<int>(leader.size())});
  }
  return table;
}

// "hand", and "hand with friction (convex)".
static bool is_hand(const std::string& family) { return family == "hand" || family.starts_with("hand "); }

std::string headline_family(const std::vector<Result>& results) {
  std::string best;
  std::size_t most = 0;
  for (const std::string& family : families_of(results)) {
    const std::size_t solvers = accuracy_matched(results, family, 1e-9).size();
    if (solvers > most || (solvers > 0 && is_hand(family))) best = family, most = solvers;
    if (is_hand(family) && solvers > 0) break;
  }
  return best;
}

std::string accuracy_headline(const RunFolder& run, double error) {
  const std::string family = headline_family(run.results);
  std::string on_all, on_some;
  int problems = 0;
  for (const AccuracyMatched& entry : accuracy_matched(run.results, family, error)) {
    problems = entry.problems;
    const bool all = entry.reached == problems;
    std::string aside = entry.ratio == 1 ? "" : ratio_text(entry.ratio);
    if (!all) aside += (aside.empty() ? "" : ", ") + part_of(entry.reached, entry.reads);
    std::string& list = all ? on_all : on_some;
    list += (list.empty() ? "" : ", ") + entry.solver + " " + duration(entry.time_s);
    if (!aside.empty()) list += " (" + aside + ")";
  }
  if (problems == 0) return "";
  std::string subject = is_hand(family) ? "hand" : family + " problem";
  subject = problems == 1 ? "one " + subject : std::to_string(problems) + " " + subject + "s";
  if (!on_all.empty() && !on_some.empty()) on_all += "; not on all: ";
  return (run.problem_class.empty() ? "On " : run.problem_class + ": on ") + subject + " at " + scientific(error, 0) +
         " achieved error: " + on_all + on_some;
}

std::string ratio_text(double ratio) {
  if (!std::isfinite(ratio)) return "";
  return fixed(ratio, ratio < 9.95 ? 1 : 0) + "x";
}

}  // namespace zwang::report
