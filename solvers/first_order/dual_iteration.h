#pragma once

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/prover.h>

namespace zwang {

// What surrounds every step of a first-order method on the dual of a unit program (pgs.h, apgd.h): where it starts, the
// limits of steps and time, the proof that there is no solution, and the observer.
//
//   while (iteration.goes_on(limit)) {
//     ... moves lambda and y ...
//     if (iteration.step_done()) break;
//     if (...) { solution.status = Status::solved; break; }
//   }
class DualIteration {
 public:
  struct Workspace {
    UnitProgram program;
    Vector lambda, y;  // the iterate and G' lambda
    Vector marked, drift, motion;
    Sharpening sharpening;
  };

  DualIteration(Workspace& work, const Problem& problem, const SolveOptions& options, Solution& solution)
      : work_(work), problem_(problem), options_(options), solution_(solution), deadline_(options.time_limit) {}

  // Builds the program and starts from the multipliers of an earlier frame. False where the answer is already written.
  bool begin();
  // False at an end that is none of the method's own, which the solution then names.
  bool goes_on(int limit);
  // Counts the step and shows it to the observer. True where the accuracy that was asked for is proven; then written.
  bool step_done();
  void write() { work_.program.write(problem_, work_.y, work_.lambda, solution_); }

 private:
  bool runs_off();

  Workspace& work_;
  const Problem& problem_;
  const SolveOptions& options_;
  Solution& solution_;
  Deadline deadline_;
  Prover* prover_ = nullptr;
};

}  // namespace zwang
