#pragma once

#include <zwang/solvers/friction/promise.h>

namespace zwang {

// The iterate of a simple method on a cone program, and what surrounds every step: where it starts, the limits of steps
// and time, the observer, and the claim: the natural residual and what M v leaves of G'y, at the tolerance.
//
//   while (iteration.goes_on(limit)) { ... moves v and y ...; if (iteration.step_done()) break; }
class ConeIteration {
 public:
  ConeProgram program;
  Vector v, y, s;  // s = G v - h

  // Builds the program and starts from the multipliers of an earlier frame. False where the answer is already written.
  // All three are kept until the next begin().
  bool begin(const Problem& problem, const SolveOptions& options, Solution& solution,
             ConeProgram::Want want = ConeProgram::Want::any);
  bool goes_on(int limit);
  // Counts the step, measures s and the residual and shows the iterate. True where that is good enough.
  bool step_done();
  double residual() { return residual_ / program.scale(v); }
  const Deadline& deadline() const { return deadline_; }
  // Writes the last iterate, but for one that is written.
  void end();

 private:
  const Problem* problem_ = nullptr;
  const SolveOptions* options_ = nullptr;
  Solution* solution_ = nullptr;
  Deadline deadline_;
  Promise promise_;
  double residual_ = 0, work_ = 0;
};

}  // namespace zwang
