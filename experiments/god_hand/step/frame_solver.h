#pragma once

#include <optional>
#include <vector>

#include <zwang/core/problem/solver.h>
#include <zwang/experiments/god_hand/step/options.h>

namespace zwang::god {

// The solves of one cluster or grasp, frame after frame: with the solver that the options name, warm started.
//
// Under friction only what is claimed solved is an answer. Where a solve ends at its limit or breaks down, as it may
// under Coulomb's law, which need not have an answer, the rows are solved without lift, then without friction: both
// laws keep every gap and joint that the asked one keeps. For the rest of the frame the law stays the simpler one, and
// the frame is `limited`. Each solve may take half of the time that is left.
class FrameSolver {
 public:
  // Throws std::invalid_argument with the nearest name.
  explicit FrameSolver(const Options& options);

  void begin() { law_.reset(); }  // a frame
  // Is there a z to use? seconds: of CPU time, left of the frame's budget. Afterwards the problem is of the law that
  // was answered. Without friction the last iterate of a method that stopped early will do, but not of one that had no
  // time: the sweep stops what is wrong about it.
  bool solve(Problem& problem, double seconds, Solution& solution);
  bool limited() const { return law_.has_value(); }  // since begin(); also where no law had an answer
  Status claimed() const { return claimed_; }        // of the last problem, under the law that it came with
  void forget();                                     // warm starts

 private:
  AnySolver& method_for(const Problem& problem);
  bool is_answer(const Problem& problem, const Solution& solution) const;

  Options options_;
  SolveOptions asked_;
  AnySolver solver_, plain_, convex_;  // plain: of what has no tangent rows; convex: of the law without lift
  WarmStart warm_;
  std::optional<Law> law_;  // of a frame that is limited
  Status claimed_ = Status::unsolved;
};

// What is left of the budget of a frame whose solves took so many seconds.
double left_of(const Options& options, double seconds);

// The rows of the last `contacts` constraints of a problem, which are contacts: the first one of each.
void first_rows(const Problem& problem, std::size_t contacts, std::vector<Index>& rows);

Status worse(Status a, Status b);

}  // namespace zwang::god
