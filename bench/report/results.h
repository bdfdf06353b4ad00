#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <zwang/bench/results/result.h>

namespace zwang::report {

struct SolverInfo {
  std::string name = {}, method = {}, limits = {};
  bool foreign = false;
  bool exact = false;      // its answer does not depend on the tolerance
  std::string style = {};  // the name that picks its colour: two runs of one solver share it ("" = name)
  bool second = false;     // of the second of two runs
};

// What the folder of a run holds.
struct RunFolder {
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
// and reason in one line. Of more than `large` results only what charts need is kept.
RunFolder read_run(const std::filesystem::path& dir, std::size_t large = RunFolder::large);

// The run's problems by class, those without any left out: QP (frictionless, or pyramids of friction), convex cone,
// Coulomb. Classes are never averaged: few solvers read all of them, and they cost differently. A solver is in the
// classes of which it reads a problem.
std::vector<RunFolder> by_class(RunFolder run);

// One run that holds both: names of solvers in both get " @A" and " @B", problems with the same contents one name.
RunFolder merged(const RunFolder& a, const RunFolder& b);

// Everything the charts group by, in the order of appearance.
std::vector<std::string> families_of(const std::vector<Result>& results);
std::vector<std::string> solvers_of(const std::vector<Result>& results);

// `./zwang solve DIR/problems/0007.h5 --solver nnls --tolerance 1e-8`; read_run puts it into Result::replay.
std::string replay_command(const std::filesystem::path& dir, const Result& result);
std::string replay_of(const RunFolder& run, const Result& result);

}  // namespace zwang::report
