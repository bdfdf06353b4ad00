#include <zwang/bench/report/page/page.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/tables/profile.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/tables/tables.h>
#include <zwang/bench/report/tables/work_precision.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

using nlohmann::json;

constexpr std::size_t curve_steps = 60;
constexpr std::size_t trace_points = 60;
constexpr std::size_t sweep_columns = 60, marks = 2000;  // of a chart of a large run

// Whether the i-th of `of` is among the `most` evenly chosen ones.
bool chosen(std::size_t i, std::size_t of, std::size_t most) {
  return of <= most || i == 0 || i * most / of != (i - 1) * most / of;
}

json known(double value, int digits = 4) {
  // Four digits draw the same picture in a third of the bytes.
  return std::isfinite(value) ? json::parse(scientific(std::clamp(value, -1e300, 1e300), digits - 1)) : json();
}

// "a b" and rows -> {"fields": ["a", "b"], "rows": [...]}.
json chart(const std::string& fields, const json& rows) {
  std::istringstream words(fields);
  return {{"fields", std::vector<std::string>(std::istream_iterator<std::string>(words), {})}, {"rows", rows}};
}

// An answer that came with a problem has an error and no time: one row a problem, and the median of each family.
void add_recorded(const RunFolder& run, json& rows) {
  InOrder<std::pair<std::string, std::string>, std::vector<const Result*>> families;
  const auto add = [&rows](const char* level, const Result& r, double error, const std::string& verified,
                           const std::string& of) {
    rows.push_back({level, r.family, r.problem, r.solver, known(r.tolerance), "recorded", known(error), json(), json(),
                    json(), json(), json(), r.claim(), verified, of, ""});
  };
  for (const Result& r : run.recorded)
    if (std::isfinite(r.metrics.z_error)) {
      add("run", r, r.metrics.z_error, r.verdict(), "a recorded answer");
      families[{r.family, r.solver}].push_back(&r);
    }
  for (const auto& [key, answers] : families.items) {
    std::vector<double> errors;
    for (const Result* r : answers) errors.push_back(r->metrics.z_error);
    const Result& any = *answers.front();
    add("median", any, median(errors), answers.size() == 1 ? any.verdict() : "",
        "median of " + std::to_string(answers.size()) + " recorded answers");
  }
}

json work_precision(const RunFolder& run) {
  json rows = json::array();
  for (const DrawnRun& d : work_precision_points(run)) {
    const Result& r = *d.run;
    rows.push_back({d.level, r.family, r.problem, r.solver, known(r.tolerance), drawn_as(r), known(d.error),
                    known(d.time_s), known(d.q1_s), known(d.q3_s), known(d.prepare_s), known(d.iterations, 6),
                    r.claim(), r.verdict(), d.of, replay_of(run, r)});
  }
  add_recorded(run, rows);
  return chart(
      "level family problem solver tolerance drawn error time q1 q3 prepare iterations claimed verified of replay",
      rows);
}

// At most curve_steps steps, evenly chosen, the last one kept.
Curve thinned(const Curve& curve) {
  if (curve.size() <= curve_steps) return curve;
  Curve out;
  for (std::size_t i = 0; i < curve_steps; ++i) out.push_back(curve[i * (curve.size() - 1) / (curve_steps - 1)]);
  return out;
}

json profiles(const RunFolder& run) {
  const auto solvers = names(run);
  const auto groups = group_by_problem(run.results, solvers);
  std::vector<std::string> families = families_of(run.results);
  families.insert(families.begin(), "");
  json rows = json::array();
  for (const std::string& family : families)
    for (const double error : error_levels) {
      const Times times = times_to_error(groups, family, error);
      const auto add = [&](const char* kind, const std::vector<Curve>& curves, double start) {
        double end = start;
        for (const Curve& curve : curves)
          if (!curve.empty()) end = std::max(end, curve.back().at);
        for (std::size_t s = 0; s < curves.size(); ++s) {
          const auto reads = std::ranges::count_if(times, [s](const auto& row) { return !std::isnan(row[s]); });
          if (reads == 0) continue;
          const Curve curve = thinned(curves[s]);
          const auto add_step = [&](double at, double share) {
            rows.push_back({kind, family, known(error), solvers[s], known(at), known(share), reads});
          };
          const double last = curve.empty() ? 0 : curve.back().share;
          // Every staircase runs from the left edge to the right one, also that of a solver that solves nothing.
          if (curve.empty() || curve.front().at > start) add_step(start, 0);
          for (const Step& step : curve) add_step(step.at, step.share);
          add_step(1.3 * end, last);
        }
      };
      double first = std::numeric_limits<double>::infinity();
      for (const auto& row : times)
        for (const double t : row) first = std::min(first, t);
      if (!std::isfinite(first)) continue;
      add("ratio", performance_profile(times), 1);
      add("time", data_profile(times), 0.8 * first);
    }
  return chart("kind family level solver at share reads", rows);
}

json sweep_states(const RunFolder& run) {
  json rows = json::array();
  const auto solvers = names(run);
  std::map<std::string, int> position;  // problems in file order, benign to hard
  const std::vector<ProblemRuns> groups = group_by_problem(run.results, solvers);
  std::map<std::string, std::size_t> problems;
  for (const ProblemRuns& group : groups) ++problems[group.family];
  for (const ProblemRuns& group : groups) {
    if (!is_stability_family(group.family)) continue;
    const int at = position[group.family]++;
    if (run.is_large() && !chosen(static_cast<std::size_t>(at), problems[group.family], sweep_columns)) continue;
    for (const auto& runs : group.by_solver) {
      if (runs.empty()) continue;
      const Result& r = *tightest(runs);
      const std::string knob = std::isfinite(r.knob_value) ? knob_text(r.knob_value) : r.problem;
      rows.push_back({r.family, r.problem, r.knob, knob, at, r.solver, sweep_state(r), known(r.error()), r.claim(),
                      r.verdict(), replay_of(run, r), sweep_mark(r), r.problem_file});
    }
  }
  return chart("family problem knob value position solver state error claimed verified replay mark file", rows);
}

json scaling_points(const RunFolder& run, bool fits) {
  json rows = json::array();
  for (const Scaling& family : scaling(run.results, names(run), 1e-6)) {
    if (fits)
      for (const ScalingFit& fit : family.fits)
        for (const double size : {fit.from, fit.to})
          rows.push_back({family.family, fit.solver, known(size, 9),
                          known(fit.law.factor * std::pow(size, fit.law.exponent)), known(fit.law.exponent, 3)});
    else
      for (std::size_t i = 0; i < family.points.size(); ++i) {
        if (run.is_large() && !chosen(i, family.points.size(), marks)) continue;
        const ScalingPoint& p = family.points[i];
        rows.push_back({family.family, family.axis, p.solver, p.result->problem, known(p.size, 9), known(p.time_s),
                        p.result->n, p.result->m, replay_of(run, *p.result)});
      }
  }
  if (fits) return chart("family solver size time exponent", rows);
  return chart("family axis solver problem size time n m replay", rows);
}

json convergence(const RunFolder& run) {
  json rows = json::array();
  InOrder<std::pair<std::string, std::string>, std::vector<const TracePoint*>> traces;
  for (const TracePoint& point : run.traces) traces[{point.problem, point.solver}].push_back(&point);
  for (auto& [key, trace] : traces.items) {
    std::ranges::sort(trace, {}, &TracePoint::iteration);
    // Each point is a solve of its own, and times scatter; but who stops earlier cannot have needed longer.
    std::vector<double> time(trace.size(), unknown);
    for (std::size_t i = trace.size(); i-- > 0;)
      time[i] = i + 1 < trace.size() ? std::fmin(trace[i]->time_s, time[i + 1]) : trace[i]->time_s;
    // Long traces are thinned evenly in the logarithm of the iteration; first and last stay.
    long next = 0;
    const double growth = std::pow(static_cast<double>(std::max(trace.back()->iteration, 2L)), 1.0 / trace_points);
    for (std::size_t i = 0; i < trace.size(); ++i) {
      const TracePoint* p = trace[i];
      if (trace.size() > trace_points && p->iteration < next && p != trace.back()) continue;
      next = std::max(p->iteration + 1, static_cast<long>(static_cast<double>(p->iteration) * growth));
      rows.push_back({p->family, p->problem, p->solver, p->iteration, known(time[i]), known(p->z_error),
                      known(p->primal), known(p->stationarity), known(p->gap)});
    }
  }
  return chart("family problem solver iteration time z_error primal stationarity gap", rows);
}

json range_gaps(const RunFolder& run) {
  json rows = json::array();
  std::vector<const Result*> drawn;
  for (const Result& r : run.results)
    if (std::isfinite(r.range_gap) && std::isfinite(r.metrics.z_error)) drawn.push_back(&r);
  for (std::size_t i = 0; i < drawn.size(); ++i)
    if (const Result& r = *drawn[i]; !run.is_large() || chosen(i, drawn.size(), marks))
      rows.push_back({r.family, r.problem, r.solver, r.m, known(r.tolerance), known(r.range_gap),
                      known(r.metrics.z_error), r.claim(), r.verdict(), replay_of(run, r)});
  return chart("family problem solver m tolerance gap error claimed verified replay", rows);
}

json stages(const RunFolder& run) {
  json rows = json::array();
  for (const StageTimes& t : run.stages) {
    double whole = 0;
    for (const double time : t.seconds)
      if (std::isfinite(time)) whole += time;
    for (std::size_t k = 0; k < t.stages.size(); ++k)
      rows.push_back({t.contacts, t.stages[k], k, known(t.seconds[k]), known(t.seconds[k] / whole, 3)});
  }
  return chart("contacts stage order time share", rows);
}

}  // namespace

std::string chart_rows(const RunFolder& run) {
  return json{{"work-precision", work_precision(run)},
              {"profile", profiles(run)},
              {"sweep", sweep_states(run)},
              {"scaling", scaling_points(run, false)},
              {"fit", scaling_points(run, true)},
              {"convergence", convergence(run)},
              {"range-gap", range_gaps(run)},
              {"stages", stages(run)}}
      .dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace zwang::report
