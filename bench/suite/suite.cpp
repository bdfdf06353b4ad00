#include <zwang/bench/suite/suite.h>

#include <algorithm>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/results/seal.h>
#include <zwang/bench/suite/flow.h>
#include <zwang/bench/suite/phenomena.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/suite/run_record.h>
#include <zwang/bench/suite/schedule.h>
#include <zwang/bench/suite/speed.h>
#include <zwang/bench/suite/trace.h>
#include <zwang/bench/timing/conditions.h>

namespace zwang {
namespace {

// run.json of a new run, or of the one that goes on.
RunRecord open_record(const Plan& plan, const SuiteSettings& settings) {
  const auto& directory = settings.directory;
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
  if (const std::string line = not_built_in(absent_solvers()); !line.empty()) record.notes.push_back(line);
  for (const Instance& i : plan.instances)
    for (const std::string& note : i.notes) {
      const std::string line = i.problem.name + ": " + note;
      if (std::find(record.notes.begin(), record.notes.end(), line) == record.notes.end()) record.notes.push_back(line);
    }
  write_run_record(directory, plan, settings.solvers, record);
  return record;
}

// What a problem under a simpler law is measured against; none where Coulomb's law has no known solution.
std::optional<Reference> coulomb_reference_of(const Plan& plan, std::size_t b, const std::filesystem::path& cache) {
  const auto found = plan.coulomb.find(b);
  if (found == plan.coulomb.end()) return {};
  std::optional<Reference> reference = reference_for(found->second, cache, {}).reference;
  if (reference && !reference->feasible) reference.reset();
  return reference;
}

}  // namespace

std::string not_built_in(std::span<const AbsentSolver> absent) {
  std::string line;
  for (std::size_t k = 0; k < absent.size(); ++k) {
    const bool last = k + 1 == absent.size() || absent[k + 1].how_to_add != absent[k].how_to_add;
    line.append(line.empty() ? "Not built in: " : ", ").append(absent[k].name);
    if (last) line.append(" (").append(absent[k].how_to_add).append(")");
  }
  return line;
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
  const auto alone = only_writer(directory);
  Stored stored = load_results(directory / "results.jsonl");
  Outcome outcome;
  outcome.planned = plan.size();
  outcome.tally = stored.tally;
  outcome.earlier = stored.tally.runs;
  // A complete run stays as it is, its curves too.
  if (plan.size() > 0 && stored.tally.runs == plan.size() && stored.damaged == 0 &&
      !read_run_record(directory).finished.empty()) {
    require_same_problems(directory, plan);
    return outcome;
  }
  RunRecord record = open_record(plan, settings);
  // What a program gave is kept whole before anything runs: nobody else can give it again.
  for (std::size_t b = 0; b < plan.options.given; ++b)
    if (!std::filesystem::exists(directory / problem_file(b)))
      write_problem(directory / problem_file(b), plan.instances[b]);
  if (stored.damaged > 0)
    outcome.notes.push_back(grouped(stored.damaged) + " damaged lines of results.jsonl are left out; their runs were " +
                            "made again.");
  const Conditions here = conditions();
  Dispatcher desk([&](std::string_view text) { return make_solver(text, settings.solvers); });
  ResultFile results(directory / "results.jsonl");
  Schedule schedule(plan);
  Progress progress;
  std::size_t timed_once = 0;

  for (std::size_t b = 0; b < plan.instances.size() && !interrupted; ++b) {
    if (!plan.shard.holds(b)) continue;
    const std::string file = problem_file(b), sha256 = problem_sha256(plan.instances[b].problem);
    const auto cell = [&](const std::string& solver, double tolerance) {
      return cell_name(here.commit, file, sha256, solver, tolerance);
    };
    std::vector<Run> runs;
    for (const Run& run : plan.runs)
      if (!stored.finished.contains(cell(run.solver, run.tolerance))) runs.push_back(run);
    Instance instance = plan.instances[b];
    if (runs.empty()) {
      schedule.skip(instance);
      continue;
    }
    const BatchLimits limits = schedule.next(instance, plan.instances.size() - b);
    const double start = wall_seconds();
    double repeating = 0;
    const auto assemble = [&] {
      FoundReference found = reference_for(instance, settings.cache, {plan.second_witness});
      instance.reference = std::move(found.reference);
      if (!found.note.empty()) record.notes.push_back(instance.problem.name + ": " + found.note);
      write_problem(directory / file, instance);
      return instance;
    };
    const auto append = [&](const Instance&, std::vector<Cell>& cells) {
      std::vector<std::string> lines;
      const std::optional<Reference> coulomb = coulomb_reference_of(plan, b, settings.cache);
      for (auto& [result, timed] : cells) {
        result.problem_file = file;
        result.batch = static_cast<int>(b);
        result.machine = here.cpu;
        if (const Vector& z = timed.solution.z; coulomb && z.size() == coulomb->z.size() && z.allFinite())
          result.coulomb_error = relative_distance(instance.problem, coulomb->z, z);
        if (settings.amend) settings.amend(result);
        result.cell = cell(result.solver, result.tolerance);
        if (stored.finished.contains(result.cell)) continue;
        outcome.tally.count(result);
        timed_once += timed.samples.empty() && timed.first_s > 0 && timed.solution.z.size() > 0;
        for (const double s : timed.samples) repeating += std::max(s, 50e-6);
        lines.push_back(sealed(to_json(result)));
      }
      results.append(lines);
    };
    const auto show = [&](double of_batch, std::size_t i) {
      if (settings.quiet) return;
      const double fraction = schedule.fraction(of_batch);
      progress.show(fraction, instance.problem.name + "   " + runs[i].solver + " @ " + printed("%g", runs[i].tolerance),
                    schedule.left(fraction));
    };
    const Flow flow{assemble, runs, limits, append, plan.options.tolerances.back(), show};
    if (!run_flow(flow, desk, interrupted)) break;
    schedule.finished(std::max(0.0, wall_seconds() - start - repeating));
    if (settings.between) settings.between();
  }

  if (!interrupted && plan.conformance) write_phenomena(directory, plan.tightest_runs(), desk, interrupted);
  if (!interrupted && plan.speed) write_speed(directory, settings.cache, plan.runs, 80, desk, interrupted);
  if (!interrupted && plan.options.sequence && plan.shard.part == 0)
    write_sequences(plan, directory, settings.cache, desk, interrupted);
  if (!interrupted && !plan.speed && !plan.answers && (plan.shard.of == 1 || plan.options.trace)) {
    double budget = 10;
    if (plan.whole_suite && plan.limit_s > 0) budget = std::max(0.05 * plan.limit_s, plan.limit_s - schedule.elapsed());
    if (plan.options.trace) budget = std::numeric_limits<double>::infinity();
    write_traces(plan, directory, settings.cache, desk, budget, interrupted, record.notes);
  }
  if (const std::string line = laws_not_read(plan, settings.solvers); !line.empty()) {
    outcome.notes.push_back(line);
    record.notes.push_back(line);
  }
  if (timed_once > 0 && !plan.options.accuracy)
    record.notes.push_back(counted(timed_once, "run") + " timed by the first solve alone: too slow to repeat");
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
