#include "bench/suite/suite.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/references/reference.h"
#include "bench/suite/conditions.h"
#include "bench/suite/progress.h"
#include "bench/suite/record_file.h"
#include "bench/suite/run_record.h"
#include "bench/suite/speed.h"
#include "bench/suite/trace.h"

namespace zwang {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string short_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0e", x);
  return text;
}

// Shares a suite's time out to its batches. First solves cannot be dropped, so they are foreseen from those already
// made (per unknown and row) and repetitions get what is left. When even first solves will not fit, the time limit of
// a solve is halved until they do, down to 0.25 s: below that an interior-point method would be cut off on a hand. On
// scenes and files that somebody chose, and in suites without a limit, a batch spends at most 20 ms a run on
// repetitions.
class Schedule {
 public:
  Schedule(const Plan& plan) : plan_(plan), start_(wall_seconds()) {
    for (const Instance& i : plan.instances) work_left_ += work(i);
    work_all_ = work_left_;
  }

  BatchLimits next(const Instance& instance, std::size_t batches_left) {
    BatchLimits limits;
    limits.repetitions = plan_.options.repetitions;
    limits.time_limit = plan_.time_limit;
    limits.budget = std::max(0.5, 0.02 * static_cast<double>(plan_.runs.size()));
    if (plan_.limit_s > 0) {
      const double left = std::max(0.0, 0.9 * plan_.limit_s - elapsed());
      const double firsts = work_done_ > 0 ? 1.5 * first_s_ / work_done_ * work_left_ : left / 2;
      const double share = std::max(0.0, left - firsts) / static_cast<double>(batches_left);
      limits.budget = plan_.whole_suite ? share : std::min(limits.budget, share);
      // Large problems, last, make first solves look dearer than they are; a time from a first solve alone would hold
      // its allocations.
      if (plan_.speed) limits.budget = std::max(limits.budget, 1.5);
      const double allowance = left / static_cast<double>(batches_left);
      const double solvers =
          static_cast<double>(plan_.runs.size()) / static_cast<double>(plan_.options.tolerances.size());
      while (limits.time_limit >= 0.5 && limits.time_limit * solvers > 4 * allowance) limits.time_limit /= 2;
    }
    shortest_limit_ = std::min(shortest_limit_, limits.time_limit);
    batch_work_ = work(instance);
    return limits;
  }
  void finished(double first_s) {
    first_s_ += first_s;
    work_done_ += batch_work_;
    skipped();
  }
  void skipped() { work_left_ -= std::exchange(batch_work_, 0); }
  void skip(const Instance& instance) { batch_work_ = work(instance), skipped(); }

  double elapsed() const { return wall_seconds() - start_; }
  double fraction(double of_batch) const { return 1 - (work_left_ - of_batch * batch_work_) / work_all_; }
  // Work that an earlier call did took no time of this one.
  double left(double fraction) const {
    const double done = work_done_ + (fraction - this->fraction(0)) * work_all_;
    return done > 0 ? elapsed() * (1 - fraction) * work_all_ / done : -1;
  }
  double shortest_time_limit() const { return shortest_limit_; }

 private:
  static double work(const Instance& i) { return 20 + static_cast<double>(i.problem.size() + i.problem.rows()); }

  const Plan& plan_;
  double start_, work_all_ = 0, work_left_ = 0, work_done_ = 0, batch_work_ = 0, first_s_ = 0;
  double shortest_limit_ = plan_.time_limit;
};

std::string file_name(std::size_t batch) {
  char name[48];
  std::snprintf(name, sizeof name, "problems/%04zu.h5", batch);
  return name;
}

// The first problem of each family gets convergence rows (every problem with --trace), at the tightest tolerance.
void write_traces(const Plan& plan, const SuiteSettings& settings, Desk& desk, double budget,
                  const std::atomic<bool>& interrupted, std::vector<std::string>& notes) {
  using Json = nlohmann::ordered_json;
  const auto file = settings.directory / "traces.jsonl";
  std::filesystem::remove(file);
  std::vector<std::string> families;
  std::vector<const Instance*> chosen;
  for (const Instance& i : plan.instances) {
    const bool first = std::find(families.begin(), families.end(), i.family) == families.end();
    if (first) families.push_back(i.family);
    if (first || plan.options.trace) chosen.push_back(&i);
  }
  const double tightest = plan.options.tolerances.back();
  const double start = wall_seconds();
  std::size_t left = chosen.size(), cut = 0;
  ResultFile out(file);
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  for (const Instance* problem : chosen) {
    Instance instance = *problem;
    instance.reference = reference_for(instance, settings.cache, {plan.second_witness}).reference;
    // What is left of the budget is shared by the problems left, and within a problem by the solvers.
    const double share = (budget - (wall_seconds() - start)) / static_cast<double>(left--);
    const double solvers = static_cast<double>(plan.runs.size()) / static_cast<double>(plan.options.tolerances.size());
    std::vector<std::string> lines;
    for (const Run& run : plan.runs) {
      if (run.tolerance != tightest) continue;
      const double each = share / solvers;
      const auto points = each > 0 ? trace(instance, run, desk, std::min(plan.time_limit, each), each, interrupted)
                                   : std::vector<TracePoint>();
      if (interrupted) return;
      cut += points.empty();
      for (const TracePoint& p : points)
        lines.push_back(Json({{"problem", instance.problem.name},
                              {"family", instance.family},
                              {"solver", run.solver},
                              {"iteration", p.iteration},
                              {"time_s", number(p.time_s)},
                              {"z_error", number(p.metrics.z_error)},
                              {"primal", number(p.metrics.primal)},
                              {"stationarity", number(p.metrics.stationarity)},
                              {"gap", number(p.metrics.gap)}})
                            .dump());
    }
    out.append(lines);
  }
  if (cut > 0) notes.push_back(std::to_string(cut) + " convergence curves have no points: no answer within their time");
}

}  // namespace

Result to_result(Result r, const Instance& instance, const Run& run, const Timed& timed) {
  r.solver = run.solver;
  r.foreign = run.foreign;
  r.tolerance = run.tolerance;
  judge(r, instance, timed.solution);
  r.repetitions = static_cast<int>(timed.samples.size());
  if (!timed.samples.empty()) {
    const Quartiles q = quartiles(timed.samples);
    r.solve_s = q.median;
    r.solve_s_q1 = q.q1;
    r.solve_s_q3 = q.q3;
    r.setup_s = std::max(0.0, timed.first_s - q.median);
    r.allocations = timed.allocations;
  } else if (timed.first_s > 0) {
    r.solve_s = r.solve_s_q1 = r.solve_s_q3 = timed.first_s;
    r.repetitions = 1;
  }
  return r;
}

std::filesystem::path reference_cache() {
  const std::filesystem::path place = std::filesystem::path("zwang") / "references";
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return cache / place;
  if (const char* home = std::getenv("HOME"); home && *home) return home / (".cache" / place);
  return std::filesystem::temp_directory_path() / place;
}

Outcome run_suite(const Plan& plan, const SuiteSettings& settings, const std::atomic<bool>& interrupted) {
  const auto& directory = settings.directory;
  std::filesystem::create_directories(directory / "problems");
  const bool resumed = std::filesystem::exists(directory / "run.json");
  RunRecord record;
  if (resumed) {
    require_same_problems(directory, plan);
    record = read_run_record(directory);
    record.notes.clear();
  } else {
    record.command = settings.command;
    record.started = now_iso8601();
  }
  if (const Conditions c = conditions(); c.debug)
    record.notes.push_back("DEBUG BUILD (" + c.build_type + "): the times mean nothing");
  for (const Instance& i : plan.instances)
    for (const std::string& note : i.notes) {
      const std::string line = i.problem.name + ": " + note;
      if (std::find(record.notes.begin(), record.notes.end(), line) == record.notes.end()) record.notes.push_back(line);
    }
  write_run_record(directory, plan, settings.solvers, record);

  Stored stored = load_results(directory / "results.jsonl");
  Outcome outcome;
  outcome.planned = plan.size();
  outcome.tally = stored.tally;
  outcome.earlier = stored.tally.runs;
  Desk desk([&](std::string_view text) { return make_solver(text, settings.solvers); });
  ResultFile results(directory / "results.jsonl");
  Schedule schedule(plan);
  Progress progress(settings.terminal);
  std::size_t timed_once = 0;

  for (std::size_t b = 0; b < plan.instances.size() && !interrupted; ++b) {
    std::vector<Run> runs;
    for (const Run& run : plan.runs)
      if (!stored.finished.contains({file_name(b), run.solver, run.tolerance})) runs.push_back(run);
    Instance instance = plan.instances[b];
    if (runs.empty()) {
      schedule.skip(instance);
      continue;
    }
    const BatchLimits limits = schedule.next(instance, plan.instances.size() - b);
    const double start = wall_seconds();
    FoundReference found = reference_for(instance, settings.cache, {plan.second_witness});
    instance.reference = std::move(found.reference);
    if (!found.note.empty()) record.notes.push_back(instance.problem.name + ": " + found.note);
    write_problem(directory / file_name(b), instance);

    const auto show = [&](double of_batch, std::size_t i) {
      const double fraction = schedule.fraction(of_batch);
      progress.show(fraction, instance.problem.name + "   " + runs[i].solver + " @ " + short_number(runs[i].tolerance),
                    schedule.left(fraction));
    };
    std::vector<double> kernel;
    std::vector<Run> kept_away;
    if (plan.speed)
      std::erase_if(runs, [&](const Run& run) {
        const bool away = !left_out(instance.problem, run).empty();
        if (away) kept_away.push_back(run);
        return away;
      });
    std::vector<Timed> timed = time_batch(instance.problem, runs, limits, desk, interrupted, show, &kernel);
    if (timed.empty() && interrupted) break;
    for (const Run& run : kept_away) {
      runs.push_back(run);
      timed.emplace_back().solution.status = Status::unsupported;
      timed.back().solution.message = left_out(instance.problem, run);
    }

    Result problem = describe(instance);
    problem.problem_file = file_name(b);
    problem.batch = static_cast<int>(b);
    problem.kernel_s = quartiles(std::move(kernel)).median;
    std::vector<std::string> lines;
    double repeating = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const Result r = to_result(problem, instance, runs[i], timed[i]);
      outcome.tally.count(r.claimed, r.metrics.verdict);
      timed_once += timed[i].samples.empty() && timed[i].first_s > 0 && timed[i].solution.z.size() > 0;
      for (const double s : timed[i].samples) repeating += std::max(s, 50e-6);
      lines.push_back(to_json(r));
    }
    results.append(lines);
    schedule.finished(std::max(0.0, wall_seconds() - start - repeating));
  }

  if (!interrupted && plan.speed) write_speed(directory, settings.cache, plan.runs, 80, desk, interrupted);
  if (!interrupted && !plan.speed) {
    double budget = 10;
    if (plan.whole_suite && plan.limit_s > 0) budget = std::max(0.05 * plan.limit_s, plan.limit_s - schedule.elapsed());
    if (plan.options.trace) budget = std::numeric_limits<double>::infinity();
    write_traces(plan, settings, desk, budget, interrupted, record.notes);
  }
  if (timed_once > 0)
    record.notes.push_back(grouped(timed_once) + " runs were timed by their first solve alone: too slow to repeat");
  if (schedule.shortest_time_limit() < plan.time_limit) {
    outcome.notes.push_back("To keep the suite's time, the time limit of a solve went down from " +
                            duration(plan.time_limit) + " to " + duration(schedule.shortest_time_limit()) + ".");
    record.notes.push_back(outcome.notes.back());
  }
  outcome.interrupted = interrupted;
  outcome.seconds = schedule.elapsed();
  if (!outcome.interrupted) record.finished = now_iso8601();
  write_run_record(directory, plan, settings.solvers, record);
  return outcome;
}

}  // namespace zwang
