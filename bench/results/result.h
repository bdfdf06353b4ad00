#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <zwang/core/referee/measure.h>

namespace zwang {

// One line of results.jsonl: what one solver made of one problem at one tolerance (docs/formats.md).
struct Result {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  // the problem
  std::string problem = {}, family = {}, knob = {};
  double knob_value = 0;
  Index n = 0, m = 0, equalities = 0;
  std::uint64_t seed = 0;
  std::string problem_sha256 = {}, problem_file = {}, law = {};
  std::string reference = {};  // its method, or ""
  double reference_bound = unknown;
  enum class Feasible { no, yes, unknown } feasible = Feasible::unknown;
  // the run
  std::string solver = {};
  bool foreign = false;
  double tolerance = unknown;
  int batch = 0;
  // the verdict
  Status claimed = Status::unsolved;
  Metrics metrics = {};
  double coulomb_error = unknown;  // |z - z*|_M / s, z* a solution of the same problem under Coulomb's law
  std::string worst_row = {};
  struct WorstRow : TypeResidual {
    std::string name, unit;
  };
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
};

// Claims solved of a wrong z, or infeasible of a feasible problem (or the reverse).
bool lies(Status claimed, Verdict verdict);

// The parts of a result that the problem alone decides, and the referee's.
Result describe(const Instance& instance);
void judge(Result& result, const Instance& instance, const Solution& solution);

// The row of an answer that came with the problem (recorded.h): `problem` from describe(), judged like a solver's claim
// at this tolerance.
Result judge_recorded(Result problem, const Instance& instance, const RecordedAnswer& answer, double tolerance);

// One JSON object, without a line's end: NaN is null, +-Inf is +-1.797e308. With a solution: its z and lambda too.
std::string to_json(const Result& result, const Solution* with = nullptr);

// A line of results.jsonl, without its end: to_json with the name of its cell (cell.h) and its check (seal.h).
std::string to_record(const Result& result, const std::string& cell);

struct Tally {
  std::size_t runs = 0, solved = 0, near = 0, wrong = 0, undecided = 0, failed = 0, unsupported = 0, lies = 0;
  std::size_t recorded = 0;  // answers that came with their problems: no runs
  void count(std::string_view solver, Status claimed, Verdict verdict);
};

// An append-only file of lines, on the disk when append() returns.
class ResultFile {
 public:
  explicit ResultFile(const std::filesystem::path& file);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;
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
