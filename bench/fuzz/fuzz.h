#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <zwang/core/problem/instance.h>
#include <zwang/solvers/registry.h>

namespace zwang {

struct FuzzOptions {
  std::uint64_t seed = 1, first = 0, count = 1000;  // problems first .. first + count - 1
  std::string solvers = {};                         // "": every native one that is meant to be right (fuzzed_solvers)
  std::string accuracy = {};                        // asked of solvers, whose promises are checked
  bool near = false;                                // near-dependent rows (near_problem()) in place of small integers
  bool friction = false;                            // contacts with friction (frictional_problem.h) in place of both
  bool referee = false;                             // the referee instead of solvers (question_referee.h)
};

// What one solver made of all problems so far. Plain numbers: they live in memory that two processes share.
struct FuzzTally {
  std::uint64_t runs = 0;       // on problems with a known answer
  std::uint64_t solved = 0;     // z right, and said so
  std::uint64_t flagged = 0;    // z right, "solved, ill-conditioned"
  std::uint64_t proven = 0;     // infeasible, with a certificate that the referee accepts
  std::uint64_t undecided = 0;  // gave up, and said so
  std::uint64_t faults = 0;
  std::uint64_t promised = 0, tight = 0;  // bounds on the error; of them at most ten times the error, or 1e-11
  std::uint64_t warm = 0, spoilt = 0;     // runs with warm starts; on spoilt entries
  // Of the referee: right answers without and with multipliers, and those of them that it leaves open.
  std::uint64_t right[2] = {}, open[2] = {};
  double worst_z_error = 0;  // among `solved`
  double seconds = 0;
  FuzzTally& operator+=(const FuzzTally& t) {
    runs += t.runs, solved += t.solved, flagged += t.flagged, proven += t.proven, undecided += t.undecided;
    faults += t.faults, warm += t.warm, spoilt += t.spoilt, seconds += t.seconds;
    promised += t.promised, tight += t.tight;
    for (const int k : {0, 1}) right[k] += t.right[k], open[k] += t.open[k];
    worst_z_error = std::max(worst_z_error, t.worst_z_error);
    return *this;
  }
  double decided() const {
    return runs == 0 ? 1 : static_cast<double>(solved + flagged + proven) / static_cast<double>(runs);
  }
};

// A claim that is not true, or an answer that depends on what it should not.
struct Fault {
  std::uint64_t number = 0;
  std::string solver = {}, what = {};
  Instance instance = {};  // with its answer, where there is one
};

// The problem with that number of a run, and its truth: certified in 100 digits (kkt_certificate.h), of promises under
// friction as planted. None where contacts under Coulomb's law may have several answers.
Instance fuzzed(const FuzzOptions& options, std::uint64_t number);

std::vector<std::string> fuzzed_solvers(const FuzzOptions& options, std::span<const SolverEntry> among);

// Looks at one problem after the other:
//
//   every problem       all solvers against that answer; a claim of infeasibility needs a proven certificate
//   every fourth        active-set methods again from random multipliers: z as before, to 1e-12
//   every eighth        one entry NaN or Inf: refused; or denormal or 1e300: no claim that both witnesses of references
//                       contradict
//   every 2000th        a sequence of 256 frames of the FLIP family, each warm-started from the frame before
//
// With friction, solvers of Coulomb's law claim answers that the referee must not refute, and that are among all there
// are where the problem is planar; every eighth has a spoilt entry, mu among them. Promises are asked under the
// convex law, of planted answers; and under Coulomb's, where they are about the convex answer of z's own slips, of what
// an interior point in wide arithmetic bounds (convex_reference()).
//
// Asked about the referee, it looks at no solver: referee_classes stand in their place.
//
// Of problems with near-dependent rows only the first is asked. Active-set methods have to be right to 1e-9, the others
// to 1000 times what "solved" allows at T = 1e-10, within 500 iterations.
class Fuzzer {
 public:
  // `tally` has one entry a solver. `at` is told which solver runs next, so that a crash can be attributed.
  Fuzzer(const FuzzOptions& options, std::span<const SolverEntry> among, std::span<FuzzTally> tally,
         std::function<void(std::size_t)> at, std::function<void(Fault)> report);
  void look(std::uint64_t number);

 private:
  struct Candidate {
    std::string name;
    bool exact, repeats;  // right to rounding; and from whatever start
    AnySolver solver;
    Solution solution = {};
  };
  void against_truth(std::uint64_t number, const Problem& problem, const Reference& truth);
  void weigh_promise(std::size_t i, std::uint64_t number, const Problem& problem, const Reference& truth, double error);
  void promised_under_friction(std::uint64_t number, const Problem& problem);
  void under_friction(std::uint64_t number, const Problem& problem);
  void with_spoilt_friction(std::uint64_t number, Problem problem);
  void from_random_multipliers(std::uint64_t number, const Problem& problem);
  void with_spoilt_entry(std::uint64_t number, const Problem& problem);
  void film(std::uint64_t number);
  const Solution& solve(std::size_t i, const Problem& problem, const WarmStart* warm = nullptr);
  void fault(std::size_t i, std::uint64_t number, std::string what, Problem problem, const Reference* truth = nullptr);

  FuzzOptions options_;
  std::vector<std::string> names_;
  std::vector<Candidate> candidates_;
  std::span<FuzzTally> tally_;
  std::function<void(std::size_t)> at_;
  std::function<void(Fault)> report_;
};

}  // namespace zwang
