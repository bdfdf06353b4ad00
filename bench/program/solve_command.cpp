#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/references/reference.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/flow.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/bench/suite/trace.h>
#include <zwang/core/problem/wording.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

constexpr double budget = 0.3;  // s for repetitions

std::string some_of(std::vector<std::string> names, std::size_t most) {
  const bool more = names.size() > most;
  names.resize(std::min(names.size(), most));
  return joined(names) + (more ? ", ..." : "");
}

// The problem of that name, or the only one.
Instance choose(const std::string& file, std::vector<Instance> all, const std::string& name) {
  const std::vector<std::string> names = names_of(all, [](const Instance& i) { return i.problem.name; });
  for (Instance& instance : all)
    if (instance.problem.name == name || (name.empty() && all.size() == 1)) return std::move(instance);
  if (!name.empty()) throw std::invalid_argument(file + ": no problem '" + name + "'" + did_you_mean(name, names));
  throw std::invalid_argument(file + " holds " + std::to_string(names.size()) +
                              " problems: choose one with --problem (" + some_of(names, 5) + ")");
}

void print(const Result& r, bool chosen) {
  using report::duration, report::scientific;
  const Metrics& k = r.metrics;
  const auto line = [](const char* what, const std::string& text) { std::printf("%-10s %s\n", what, text.c_str()); };
  line("problem", r.problem + "   " + std::to_string(r.n) + " unknowns, " + std::to_string(r.m) + " rows (" +
                      std::to_string(r.equalities) + " equalities)");
  line("solver", r.solver + " @ " + scientific(r.tolerance) + (chosen ? "   chosen for this problem" : ""));
  if (!r.handed_to.empty())
    line("answered", "by " + r.handed_to + ", to which " + r.solver + " handed this problem over");
  line("claimed", std::string(to_string(r.claimed)));
  std::string against = r.feasible == false     ? "no z meets all rows as they are stored (" + r.reference + ")"
                        : std::isnan(k.z_error) ? "no reference"
                                                : "z_error " + scientific(k.z_error) + " against " + r.reference;
  if (std::isinf(k.z_bound))
    against += "; no distance from the solution could be proved without one";
  else if (!std::isnan(k.z_bound))
    against += "; without it at most " + scientific(k.z_bound) + " (" + k.bound_method + ")";
  if (!r.accuracy.empty())
    line("promised", std::isfinite(r.error_bound) ? "error at most " + scientific(r.error_bound) + " of the motion (" +
                                                        r.accuracy + " was asked for)   " + r.promise
                                                  : "no bound on the error was had: solved to the tolerance");
  line("verified", std::string(to_string(k.verdict)) + "   " + against + (r.lies() ? "   FALSE CLAIM" : ""));
  if (r.claimed == Status::unsupported || r.claimed == Status::bad_input) {  // nothing was solved
    if (!r.message.empty()) line("message", r.message);
    return;
  }
  line("residuals", "primal " + scientific(k.primal) + "   dual " + scientific(k.dual) + "   stationarity " +
                        scientific(k.stationarity) + "   complementarity " + scientific(k.complementarity) + "   gap " +
                        scientific(k.gap) + "   (M-norm, unit rows, relative)");
  if (!r.worst_row.empty()) line("worst row", r.worst_row + ", violated by " + scientific(k.primal));
  for (const WorstRow& worst : r.worst_by_type)
    line("", worst.type + ": " + scientific(worst.violation) + (worst.unit.empty() ? "" : " " + worst.unit) + ", " +
                 scientific(worst.relative) + " relative, at " + worst.name);
  if (!r.conflicting.empty())
    line("conflict", some_of(r.conflicting, 8) +
                         (k.farkas > 0 ? "   (no z within " + scientific(k.farkas) + " motions)" : "   (no proof)"));
  line("time", duration(r.solve_s) + " (quartiles " + duration(r.solve_s_q1) + ", " + duration(r.solve_s_q3) + ", " +
                   std::to_string(r.repetitions) + " repetitions)   of it " +
                   duration(std::min(r.prepare_s, r.solve_s)) + " to prepare the problem's form   set-up " +
                   duration(r.setup_s) + "   " + std::to_string(r.iterations) + " iterations");
  if (!r.message.empty()) line("message", r.message);
}

void print(const std::vector<TracePoint>& points) {
  using report::duration, report::scientific;
  const auto line = [](const std::string& iteration, const std::string& time, const std::string& error,
                       const std::string& primal, const std::string& stationarity, const std::string& gap) {
    std::printf("%9s %11s %9s %9s %13s %9s\n", iteration.c_str(), time.c_str(), error.c_str(), primal.c_str(),
                stationarity.c_str(), gap.c_str());
  };
  std::puts("");
  line("iteration", "time", "z_error", "primal", "stationarity", "gap");
  for (const TracePoint& p : points)
    line(std::to_string(p.iteration), duration(p.time_s), scientific(p.z_error), scientific(p.primal),
         scientific(p.stationarity), scientific(p.gap));
}

}  // namespace

int solve_command(std::vector<std::string> words) {
  CLI::App options(
      "Solves one problem file (zwang's or FCLIB's HDF5, Siconos' .dat) and says whether the answer is right.");
  introduce(options, "solve",
            "  ./zwang solve hand.h5\n"
            "  ./zwang solve results/20261120-2354/problems/0007.h5 --solver nnls --tolerance 1e-8\n"
            "  ./zwang solve H16.h5 --problem h3 --solver ipopt --json\n"
            "  ./zwang solve rod.h5 --law coulomb --solutions\n"
            "--json prints one object: the keys of a line of results.jsonl (docs/formats.md), z and lambda; with\n"
            "--trace also \"trace\".");
  std::string file, name;
  Run run;
  double time_limit = 60;
  bool with_trace = false, json = false, solutions = false, check = false;
  std::optional<Law> law;
  options.add_option("FILE", file, "the problem")->required();
  options.add_option("--problem", name, "its name, where the file holds several")->type_name("NAME");
  options
      .add_option("--solver", run.solver,
                  "name, or name:key=value,... (./zwang solvers); default: auto, by the table of docs/performance.md")
      ->type_name("NAME");
  within(tolerances,
         options.add_option("--tolerance", run.tolerance, "relative, in the M-norm on unit rows; default: 1e-10"))
      ->type_name("T");
  options
      .add_option("--accuracy", run.accuracy,
                  "ends as soon as a bound on the error is at most that: 1e-4 (of the motion, in the M-norm) or\n"
                  "1e-4m/s (the speed of any body)")
      ->type_name("A");
  within(above(0, "s"), options.add_option("--time-limit", time_limit, "CPU time of the solve; default: 60"))
      ->type_name("S");
  options.add_flag("--check", check, "exit code 1 where the claim is false");
  options.add_flag("--trace", with_trace, "the iterates on the way, with the time to reach them");
  options.add_flag("--json", json, "print one JSON object");
  options.add_flag("--solutions", solutions,
                   "instead of a solver: how many solutions Coulomb's law has, each proven (docs/friction.md)");
  add_law(options, law);
  if (!read(options, std::move(words))) return done;
  if (solutions) {
    if (!run.solver.empty() || with_trace)
      throw std::invalid_argument("--solutions goes with neither --solver nor --trace");
    print_solutions(choose(file, read_problems(file, law), name), json);
    return done;
  }
  SolveOptions().read_accuracy(run.accuracy);  // its complaint comes before the file's
  const bool chosen = run.solver.empty() || run.solver == "auto";
  if (!chosen) make_solver(run.solver);  // its complaint comes before the file's
  if (find_scene(file.substr(0, file.find('('))) && !std::filesystem::exists(file))
    throw BadFile(file + ": no such file; expected an HDF5 file (of this scene: ./zwang export)");
  Instance instance = choose(file, read_problems(file, law), name);
  if (const std::string reason = why_bad(instance.problem); !reason.empty()) throw BadFile(file + ": " + reason);
  if (chosen) run.solver = usual_solver(instance.problem);
  run.foreign = runs_apart(run.solver);

  std::vector<std::string> notes;
  const auto assemble = [&] {
    FoundReference found = reference_for(instance, reference_cache());
    instance.reference = std::move(found.reference);
    notes = instance.notes;
    if (!found.note.empty()) notes.push_back(found.note);
    return instance;
  };
  Cell cell;
  const auto keep = [&](const Instance&, std::vector<Cell>& cells) {
    cell = std::move(cells[0]);
    cell.result.problem_file = file;
  };
  const std::atomic<bool> interrupted = false;
  Dispatcher desk;
  run_flow({assemble, {run}, {.time_limit = time_limit, .budget = budget}, keep}, desk, interrupted);
  const auto points =
      with_trace ? trace(instance, run, desk, time_limit, time_limit, interrupted) : std::vector<TracePoint>();
  const int code = check && cell.result.lies() ? 1 : done;
  if (json) {
    const Solution& s = cell.timed.solution;
    SolvedResult solved{cell.result, {s.z.begin(), s.z.end()}, {s.lambda.begin(), s.lambda.end()}};
    if (with_trace) solved.trace = points;
    std::puts(to_json(solved).c_str());
    return code;
  }
  for (const std::string& note : notes) std::printf("Note: %s\n", note.c_str());
  print(cell.result, chosen);
  if (with_trace) print(points);
  return code;
}

}  // namespace zwang
