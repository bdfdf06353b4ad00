#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <zwang/bench/timing/batch.h>
#include <zwang/core/files/problem_file.h>

namespace zwang {

// The options of a run as typed. Empty or 0: the suite's own choice.
struct SuiteOptions {
  std::string suite = "standard";
  std::string scenes = {};
  std::string families = {};                         // "MR,NPE": of the problems, only these
  std::vector<std::filesystem::path> problems = {};  // files, or folders of *.h5 and *.hdf5
  std::vector<Instance> instances = {};              // problems of a host's own
  std::vector<Law> laws = {};                        // each problem under each of them; none: its own
  std::string solvers = {};                          // "nnls,nlopt:algorithm=2"
  std::vector<double> tolerances = {};
  int repetitions = 0;
  double time_limit = 0;  // s of CPU time a solve; one that was asked for is never shortened
  std::uint64_t seed = 1;
  bool trace = false;
  bool sequence = false;   // the problems of a family are successive frames
  std::size_t given = 0;   // how many of the problems, the first ones, are `instances`
  bool accuracy = false;   // no repetitions
  std::string shard = {};  // "K/N": only the K-th of N parts, K from 0; "": all
};

// Every N-th problem of a suite, from the K-th on: problems of one family grow, so that parts take about as long.
struct Shard {
  std::size_t part = 0, of = 1;
  bool holds(std::size_t problem) const { return problem % of == part; }
};
Shard read_shard(const std::string& text);  // "K/N" or "". Throws std::invalid_argument.

// A named choice of scenes and tolerances that fits into a time: everyday scenes (towers, hands), and the families in
// which methods are known to fail. They are listed in suites.json.
struct Suite {
  std::string name;
  std::string scenes;
  std::vector<double> tolerances;
  double limit_s;              // of the whole run, references and repetitions included; 0: none
  double time_limit;           // s of CPU time a solve
  bool fills_time = true;      // repeats runs until limit_s is spent
  std::string solvers = {};    // those of them that there are; "": all
  bool accuracy = false;       // no repetitions
  bool speed = false;          // with measured files, sequences and assembly (speed.h)
  std::vector<Law> laws = {};  // of its own scenes
  bool conformance = false;    // with every solver's phenomena of friction (bench/conformance)
};
std::span<const Suite> suites();
const Suite& find_suite(const std::string& name);  // throws std::invalid_argument with the nearest name

// Which solver on which problem at which tolerance. Batch i is instances[i] with every run.
struct Plan {
  SuiteOptions options = {};  // with nothing left to choose
  double limit_s = 0, time_limit = 0;
  bool whole_suite = false;  // its own scenes: the whole of limit_s may be spent
  bool speed = false;
  bool second_witness = false;  // references are checked by a second method
  Shard shard = {};             // whose problems are run; budgets that shorten time limits are off in a part
  bool conformance = false;
  bool answers = false;                  // the runs are answers that files hold: there is nothing to time or to trace
  std::vector<Instance> instances = {};  // of all parts
  // Of several laws: what an instance under a simpler one is under Coulomb's.
  std::map<std::size_t, Instance> coulomb = {};
  std::vector<Run> runs = {};  // a solver's tolerances from loose to tight
  std::size_t problems() const { return (instances.size() + shard.of - 1 - shard.part) / shard.of; }
  std::size_t size() const { return problems() * runs.size(); }
  std::string title() const;  // "standard suite", or "your problems"
  std::size_t solvers() const { return runs.size() / options.tolerances.size(); }
  std::vector<Run> tightest_runs() const;  // at the tightest tolerance: one a solver
};

// `among`: the solvers there are. Throws std::invalid_argument (unknown names, tolerances outside (0, 1)) or BadFile
// (files that cannot be read, or whose M is not positive definite).
Plan make_plan(SuiteOptions options, std::span<const SolverEntry> among = solvers());

// "pyramid,convex" -> laws, each once. Throws std::invalid_argument.
std::vector<Law> parse_laws(const std::string& text);
std::string words_of(std::span<const Law> laws, const char* separator = ",");  // and back

// "" or one line: which of the plan's solvers cannot read the law of how many of its problems.
std::string laws_not_read(const Plan& plan, std::span<const SolverEntry> among);

// "a,b:key=1,key=2,c" -> a | b:key=1,key=2 | c.
std::vector<std::string> split_solvers(const std::string& text);

// One line saying why the problem cannot be solved by anybody, or "".
std::string why_bad(const Problem& problem);

}  // namespace zwang
