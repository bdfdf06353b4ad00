#pragma once

#include <array>
#include <string>

#include <zwang/bench/results/statistics.h>

namespace zwang {

// Records of a run: lines of results.jsonl (result.h), traces.jsonl, speed.jsonl and conformance.jsonl. Each states its
// columns once, in the order of a line, in `columns`: visit(key, member, key, member, ...), with a Column before them
// where it is not the usual one. docs/formats.md says what they mean. What is not known is NaN, null in a line.
struct Column {
  bool written = true;
  bool null = false;  // the member's value says that there is none
};

// Calls each(key, member, column) for one column after the other.
template <class Each>
struct Columns {
  Each each;

  template <class Member, class... Rest>
  void operator()(const Column& column, const std::string& key, Member& member, Rest&&... rest) const {
    each(key, member, column);
    if constexpr (sizeof...(rest) > 0) (*this)(column, rest...);
  }
  template <class Member, class... Rest>
  void operator()(const std::string& key, Member& member, Rest&&... rest) const {
    (*this)(Column(), key, member, rest...);
  }
};

// The state after `iteration` steps.
struct TracePoint {
  std::string problem = {}, family = {}, solver = {};  // "" in what `solve --trace` prints
  long iteration = 0;
  double time_s = unknown;  // of a solve stopped there
  double z_error = unknown, primal = unknown, stationarity = unknown, gap = unknown;

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit(Column{.written = !r.solver.empty()}, "problem", r.problem, "family", r.family, "solver", r.solver);
    visit("iteration", r.iteration, "time_s", r.time_s);
    visit("z_error", r.z_error, "primal", r.primal, "stationarity", r.stationarity, "gap", r.gap);
  }
};

// Median and quartiles.
template <class Self, class Visit>
void visit_quartiles(const std::string& key, Self& r, Visit& visit) {
  visit(key, r.median, key + "_q1", r.q1, key + "_q3", r.q3);
}

// One scene assembled over and over.
struct AssemblyTimes {
  static constexpr const char* kind = "assembly";
  std::string scene = {};
  long contacts = 0, n = 0, m = 0, allocations = 0;
  double kernel_s = unknown;
  Quartiles assemble_s = {}, islands_s = {};

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit("scene", r.scene, "contacts", r.contacts, "n", r.n, "m", r.m);
    visit("allocations", r.allocations, "kernel_s", r.kernel_s);
    visit_quartiles("assemble_s", r.assemble_s, visit);
    visit_quartiles("islands_s", r.islands_s, visit);
  }
};

// Where dual_active_set's time goes on one problem of jointed bodies.
struct StageTimes {
  static constexpr const char* kind = "stages";
  // The input's checks and the search for islands; unit rows, body by body (body_rows.h); the joint graph's elimination
  // and null space (null_space_form.h); violated rows reduced, and active-set steps (dense_dual_active_set.h); the
  // answer, its residuals in double-double, the check of all rows.
  static constexpr std::array<const char*, 5> stages = {"checks", "whiten", "joints", "climb", "refine"};
  std::string scene = {};
  long contacts = 0;
  std::array<double, stages.size()> seconds = {};  // NaN where noise hides it

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit("scene", r.scene, "contacts", r.contacts);
    for (std::size_t k = 0; k < stages.size(); ++k) visit(stages[k], r.seconds[k]);
  }
};

// One solver over successive frames.
struct SequenceTimes {
  static constexpr const char* kind = "sequence";
  std::string sequence = {}, solver = {};
  struct Start {
    long frames = 0;
    double iterations = unknown;     // median
    double allocations = unknown;    // of one solve, the most over the frames
    double worst_z_error = unknown;  // or its proven bound, over the frames that were checked
    long checked = 0, right = 0;     // frames checked by the referee; verified solved, or infeasible with proof
    Quartiles solve_s = {};          // over the frames

    template <class Self, class Visit>
    static void columns(Self& r, Visit visit) {
      visit("frames", r.frames, "iterations", r.iterations, "allocations", r.allocations);
      visit("worst_z_error", r.worst_z_error, "checked", r.checked, "right", r.right);
      visit_quartiles("solve_s", r.solve_s, visit);
    }
  } cold = {}, warm = {};

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit("sequence", r.sequence, "solver", r.solver, "cold", r.cold, "warm", r.warm);
  }
};

// A solver on a phenomenon of friction with an exact answer.
struct Phenomenon {
  std::string solver = {}, law = {}, check = {}, expected = {};
  double off = unknown;  // NaN: no answer
  bool passes = false, applies = true;
  std::string note = {};  // what the solver said where it gave no answer

  template <class Self, class Visit>
  static void columns(Self& r, Visit visit) {
    visit("solver", r.solver, "law", r.law, "check", r.check, "expected", r.expected);
    visit("off", r.off, "passes", r.passes, "applies", r.applies, "note", r.note);
  }
};

// One JSON object, without a line's end. +-Inf is +-1.797e308.
template <class Record>
std::string to_json(const Record& record);

}  // namespace zwang
