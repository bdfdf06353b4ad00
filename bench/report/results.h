#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <zwang/bench/results/records.h>

namespace zwang::report {

// Worst violated row of one constraint type.
struct WorstRow {
  std::string type = {}, row = {};
  std::string unit = {};       // of the violation: "m/s^2", "rad/s^2" or ""
  double violation = unknown;  // in that unit
  double relative = unknown;   // on the unit row, over the scale s
};

// One line of results.jsonl (docs/formats.md). Numbers the run does not know are NaN.
struct Result {
  std::string problem = {}, family = {}, knob = {}, problem_sha256 = {}, problem_file = {}, solver = {};
  std::string claimed = {}, verified = {};
  std::string reference = {}, bound_method = {}, message = {}, worst_row = {};
  std::string handed_to = {};  // the solver that answered, where it is not the one that was asked
  std::string law = {};        // of friction
  std::string replay = {};     // the command that repeats this run; of large runs see replay_of()
  double knob_value = unknown, tolerance = unknown;
  long n = 0, m = 0, equalities = 0;
  double z_error = unknown, z_bound = unknown, primal = unknown, stationarity = unknown, gap = unknown;
  double setup_s = unknown, solve_s = unknown, solve_s_q1 = unknown, solve_s_q3 = unknown;  // [s]
  double prepare_s = unknown;      // of solve_s: bringing the problem into the method's form
  double coulomb_error = unknown;  // of a simpler law: the distance to a solution of Coulomb's
  double self_bound = unknown;     // Coulomb's law: how consistent z is with its own slip
  double kernel_s = unknown;       // the neutral kernel in the same batch
  double allocations = unknown;    // of one warm solve
  double range_gap = unknown;      // nnls_paper: |J k - c| / |c|
  long iterations = 0, repetitions = 0;
  std::optional<bool> feasible = {};
  bool fallback = false;
  std::vector<WorstRow> worst_by_type = {};
  std::vector<std::string> conflicting = {};

  // The error against the reference, or without one the proven upper bound; NaN when there is neither.
  double error() const { return z_error == z_error ? z_error : z_bound; }
  bool claims_solved() const { return claimed == "solved"; }
  // Claims an answer (or that there is none) that the referee refutes.
  bool lies() const { return verified == "wrong" && (claimed == "solved" || claimed == "infeasible"); }
  bool is_right() const { return verified == "solved" || verified == "infeasible, proven"; }
  // Proven neither right nor wrong.
  bool is_open() const { return verified == "undecided" || verified == "consistent" || verified == "rows off"; }
  bool is_blank() const { return verified == "unsupported" || verified == "bad input"; }
};

struct SolverInfo {
  std::string name = {}, method = {}, limits = {};
  bool foreign = false;
  bool exact = false;      // its answer does not depend on the tolerance
  std::string style = {};  // the name that picks its colour: two runs of one solver share it ("" = name)
  bool second = false;     // of the second of two runs
};

struct Run {
  std::filesystem::path dir;
  std::string problem_class;         // of by_class(), where there are several: "QP", "convex cone" or "Coulomb"
  std::string label;                 // names the run where two are compared
  std::string suite, title, commit;  // title: "standard suite", "your problems"
  std::vector<std::pair<std::string, std::string>> conditions;  // name and value, as the page shows them
  std::vector<std::string> notes;
  std::string judged_by;            // the command, where answers of files were judged: it repeats every line
  std::vector<SolverInfo> solvers;  // in the order of the run
  std::vector<Result> results;
  // Who handed over to whom, and on which problems. In `results` stands who answered.
  std::map<std::pair<std::string, std::string>, std::set<std::string>> handed_over;
  std::vector<Result> recorded;  // answers that came with the problems: judged, never timed, no solver's
  std::vector<TracePoint> traces;
  std::vector<AssemblyTimes> assembly;   // of the speed suite
  std::vector<SequenceTimes> sequences;  // likewise
  std::vector<StageTimes> stages;        // likewise
  std::vector<Phenomenon> phenomena;
  std::string torn;  // "" or what is not there: a line cut off by a killed run, runs that are still to come

  // So large that its page holds no single runs, and that of right ones only what charts need is kept.
  static constexpr std::size_t large = 20000;  // results
  bool is_large() const { return results.size() > large; }

  bool is_of_speed() const { return suite == "speed" || !assembly.empty(); }
};

// Reads DIR/results.jsonl, and run.json, traces.jsonl, speed.jsonl and conformance.jsonl of DIR where they exist. A
// torn last line (a killed run) is left out and noted; any other bad line throws std::runtime_error naming file, line
// and reason in one line.
Run read_run(const std::filesystem::path& dir);

// The run's problems by class, those without any left out: QP (frictionless, or pyramids of friction), convex cone,
// Coulomb. Classes are never averaged: few solvers read all of them, and they cost differently. A solver is in the
// classes of which it reads a problem.
std::vector<Run> by_class(Run run);

// Everything the charts group by, in the order of appearance.
std::vector<std::string> families_of(const std::vector<Result>& results);
std::vector<std::string> solvers_of(const std::vector<Result>& results);

// `./zwang solve DIR/problems/0007.h5 --solver nnls --tolerance 1e-8`; read_run puts it into Result::replay.
std::string replay_command(const std::filesystem::path& dir, const Result& result);
std::string replay_of(const Run& run, const Result& result);

}  // namespace zwang::report
