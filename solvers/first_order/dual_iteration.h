#pragma once

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/prover.h>

namespace zwang {

// The iterate of a first-order method on the dual of a unit program (pgs.h, apgd.h), and what surrounds every step:
// where it starts, the limits of steps and time, the proof that there is no solution, and the observer.
//
//   while (iteration.goes_on(limit)) {
//     ... moves lambda and y ...
//     if (iteration.step_done()) break;
//     if (...) { solution.status = Status::solved; break; }
//   }
class DualIteration {
 public:
  UnitProgram program;
  Vector lambda, y;  // y = G' lambda

  // Builds the program and starts from the multipliers of an earlier frame. False where the answer is already written.
  // All three are kept until the next begin().
  bool begin(const Problem& problem, const SolveOptions& options, Solution& solution);
  // False at an end that is none of the method's own, which the solution then names.
  bool goes_on(int limit);
  // Counts the step and shows it to the observer. True where the accuracy that was asked for is proven; then written.
  // left: as Prover::is_due's.
  bool step_done(double left = std::numeric_limits<double>::infinity());
  void write() { program.write(*problem_, y, lambda, *solution_); }
  void end();  // writes; of what is solved with a bound, where one is had

 private:
  bool runs_off();
  double work() const {  // so far, in multiplications
    return 4.0 * solution_->iterations * static_cast<double>(program.G.nonZeros());
  }
  double price() const;
  double outside() const { return 50000 + 100 * static_cast<double>(program.G.nonZeros()); }  // a look from there
  bool ends_before(double part, double left);
  bool holds(bool moves);
  bool move();

  const Problem* problem_ = nullptr;
  const SolveOptions* options_ = nullptr;
  Solution* solution_ = nullptr;
  Deadline deadline_;
  Vector marked_, drift_, motion_;
  Sharpening sharpening_;
  Prover* prover_ = nullptr;
  double last_left_ = 0, least_ = 0;  // least_: pivot of gram_
  bool looks_ = false;                // by holds()
  std::vector<Index> pushing_;
  Matrix gram_;
  Vector part_, near_lambda_, near_y_;
  std::vector<NearRow> near_;
};

}  // namespace zwang
