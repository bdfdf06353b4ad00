#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/bench/results/records.h>
#include <zwang/core/problem/instance.h>
#include <zwang/core/referee/measure.h>

namespace zwang {

inline bool is_right(Verdict v) { return v == Verdict::solved || v == Verdict::infeasible_proven; }

// The row of its type that a z violates most.
struct WorstRow {
  std::string type = {};       // "contact", "ball_joint", ...
  double violation = unknown;  // in the row's own unit of acceleration (J z - c)
  double relative = unknown;   // on the unit row, divided by s
  std::string name = {}, unit = {};

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit("type", r.type, "violation", r.violation, "relative", r.relative, "unit", r.unit, "row", r.name);
  }
};
std::vector<WorstRow> worst_by_type(const Instance& instance, const Vector& z);

// One line of results.jsonl: what one solver made of one problem at one tolerance.
struct Result {
  // the problem
  std::string problem = {}, family = {}, knob = {};
  double knob_value = unknown;
  Index n = 0, m = 0, equalities = 0;
  std::uint64_t seed = 0;
  std::string problem_sha256 = {}, problem_file = {}, law = {};
  std::string reference = {};  // its method, or ""
  double reference_bound = unknown;
  std::optional<bool> feasible = {};
  // the run
  std::string solver = {};
  bool foreign = false;
  double tolerance = unknown;
  std::string accuracy = {};  // as asked for, or ""
  int batch = 0;
  // the verdict
  Status claimed = Status::unsolved;
  Metrics metrics = {};
  double error_bound = unknown;    // what the solver promises
  std::string promise = {};        // "kept", "broken", "undecided", or "" where there is none
  double coulomb_error = unknown;  // |z - z*|_M / s, z* a solution of the same problem under Coulomb's law
  std::string worst_row = {};
  std::vector<WorstRow> worst_by_type = {};
  std::vector<std::string> conflicting = {};
  // the cost, s of thread CPU time
  double setup_s = unknown, solve_s = unknown, solve_s_q1 = unknown, solve_s_q3 = unknown;
  double prepare_s = unknown;  // of solve_s: bringing the problem into the method's form
  double kernel_s = unknown;   // the neutral kernel's median in the same batch
  double allocations = unknown;
  int repetitions = 0;
  // reported by the solver
  int iterations = 0;
  Margins margins = {};
  std::size_t redundant = 0;
  bool fallback = false;
  std::string handed_to = {};  // the solver that gave the answer in place of this one
  double range_gap = unknown;  // |J k - c| / |c| of nnls_paper
  std::string message = {};
  std::string machine = {};  // the CPU it ran on
  std::string cell = {};     // its name (record_file.h); "" outside a suite

  // An answer that came with its problem, "recorded:mujoco" in place of a solver: it has no time and is no run; its
  // claim is "unsolved", since nobody solved it here.
  static constexpr std::string_view recorded = "recorded:";
  bool is_recorded() const { return solver.starts_with(recorded); }
  // Claims an answer (or that there is none) that the referee refutes, or promises an accuracy that it has not.
  bool lies() const {
    return ((claimed == Status::solved || claimed == Status::infeasible) && metrics.verdict == Verdict::wrong) ||
           promise == "broken";
  }
  bool is_right() const { return zwang::is_right(metrics.verdict); }
  // Proven neither right nor wrong.
  bool is_open() const {
    return metrics.verdict == Verdict::undecided || metrics.verdict == Verdict::consistent ||
           metrics.verdict == Verdict::rows_off;
  }

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    auto& k = r.metrics;
    auto& f = k.friction;
    const Column conic{.written = r.law == "coulomb" || r.law == "convex"};
    const bool of_suite = !r.cell.empty();
    visit("problem", r.problem, "family", r.family, "knob", r.knob, "knob_value", r.knob_value);
    visit("n", r.n, "m", r.m, "equalities", r.equalities, "seed", r.seed);
    visit("problem_sha256", r.problem_sha256, "problem_file", r.problem_file, "law", r.law);
    visit("solver", r.solver, "foreign", r.foreign, "tolerance", r.tolerance);
    visit(Column{.written = !r.accuracy.empty()}, "accuracy", r.accuracy, "error_bound", r.error_bound, "promise",
          r.promise);
    visit("claimed", r.claimed, "verified", k.verdict, "z_error", k.z_error);
    visit("z_bound", k.z_bound, "bound_method", k.bound_method, "bound_sigma_min", k.bound_sigma_min);
    visit("primal", k.primal, "dual", k.dual, "stationarity", k.stationarity);
    visit("complementarity", k.complementarity, "gap", k.gap, "natural", k.natural, "scale", k.scale, "farkas",
          k.farkas);
    visit(conic, "penetration", f.penetration, "cone_violation", f.cone_violation, "dissipation", f.dissipation);
    visit(conic, "eta", f.eta, "self_bound", f.self_bound, "radius", f.radius, "delta", f.delta);
    visit(conic, "null_motion", f.null_motion, "isolated", f.isolated);
    visit(Column{.written = std::isfinite(r.coulomb_error)}, "coulomb_error", r.coulomb_error);
    visit("setup_s", r.setup_s, "solve_s", r.solve_s, "solve_s_q1", r.solve_s_q1, "solve_s_q3", r.solve_s_q3);
    visit("prepare_s", r.prepare_s, "kernel_s", r.kernel_s);
    visit("allocations", r.allocations, "repetitions", r.repetitions);
    visit("iterations", r.iterations);
    visit(Column{.null = r.reference.empty()}, "reference", r.reference);
    visit("reference_bound", r.reference_bound, "feasible", r.feasible);
    visit("worst_row", r.worst_row, "worst_by_type", r.worst_by_type);
    visit(Column{.null = r.margins.rank < 0}, "rank", r.margins.rank);
    visit("smallest_pivot", r.margins.smallest_accepted, "largest_rejected_pivot", r.margins.largest_rejected);
    visit("redundant", r.redundant, "conflicting", r.conflicting, "fallback", r.fallback, "handed_to", r.handed_to);
    visit("range_gap", r.range_gap, "message", r.message, "batch", r.batch);
    visit(Column{.written = of_suite}, "machine", r.machine, "cell", r.cell);
  }
};

// Reads such a line: a column that it lacks, or that holds something else, keeps its value. Throws where it is no
// result.
Result read_result(const std::string& line);

// What `solve --json` prints.
struct SolvedResult {
  Result result = {};
  std::vector<double> z = {}, lambda = {};
  std::optional<std::vector<TracePoint>> trace = {};

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    Result::columns(r.result, visit);
    visit("z", r.z, "lambda", r.lambda);
    if (r.trace) visit("trace", *r.trace);
  }
};

// The parts of a result that the problem alone decides, and the referee's.
Result describe(const Instance& instance);
void judge(Result& result, const Instance& instance, const Solution& solution);

// The row of an answer that came with the problem: `problem` from describe(), judged like a solver's claim
// at this tolerance.
Result judge_recorded(Result problem, const Instance& instance, const RecordedAnswer& answer, double tolerance);

struct Tally {
  std::size_t runs = 0, solved = 0, near = 0, wrong = 0, undecided = 0, failed = 0, unsupported = 0, lies = 0;
  std::size_t recorded = 0;  // answers that came with their problems: no runs
  void count(const Result& result);
};

// An append-only file of lines, on the disk when append() returns. `anew`: what it held before goes.
class ResultFile {
 public:
  explicit ResultFile(const std::filesystem::path& file, bool anew = false);
  ~ResultFile();
  ResultFile(ResultFile&&) = delete;
  void append(const std::vector<std::string>& lines);

 private:
  int file_;
};

// The cells of a stored run, read line by line. A last line that a killed run left torn is cut off the file. A damaged
// line stays where it is and counts as missing.
struct Stored {
  std::set<std::string> finished = {};  // names of cells
  Tally tally = {};
  std::size_t damaged = 0;  // lines
};
Stored load_results(const std::filesystem::path& file);

}  // namespace zwang
