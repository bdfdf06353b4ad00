#include <zwang/bench/report/page/page.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include <zwang/bench/report/tables/in_order.h>

namespace zwang::report {

using nlohmann::json;

// Consecutive problems share a script, up to this many runs: 1 MB or so, read in a few milliseconds.
constexpr std::size_t runs_of_script = 5000;

SingleRuns single_run_scripts(const RunFolder& run) {
  SingleRuns out;
  InOrder<std::string, std::vector<const Result*>> by_problem;
  for (const Result& r : run.results) by_problem[r.problem].push_back(&r);
  const auto number = [](double x) { return std::isfinite(x) ? json(x) : json(); };
  json index = json::object(), script = json::object();
  std::size_t runs = 0;
  const auto finish = [&] {
    if (runs == 0) return;
    const std::string k = std::to_string(out.scripts.size());
    out.scripts.push_back("zwang_runs(" + k + "," + script.dump(-1, ' ', false, json::error_handler_t::replace) +
                          ");\n");
    script = json::object();
    runs = 0;
  };
  for (const auto& [problem, results] : by_problem.items) {
    if (runs > 0 && runs + results.size() > runs_of_script) finish();
    json rows = json::array();
    for (const Result* r : results)
      rows.push_back({r->solver, number(r->tolerance), r->claim(), r->verdict(), number(r->error()), number(r->solve_s),
                      r->iterations, replay_of(run, *r)});
    script[problem] = std::move(rows);
    runs += results.size();
    index[results.front()->family].push_back({problem, out.scripts.size()});
  }
  finish();
  out.index = index.dump(-1, ' ', false, json::error_handler_t::replace);
  return out;
}

}  // namespace zwang::report
