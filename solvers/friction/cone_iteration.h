#pragma once

#include <zwang/solvers/friction/promise.h>

namespace zwang {

// What surrounds every step of a simple method on a cone program: where it starts, the limits of steps and time, the
// observer, and the claim: the natural residual and what M v leaves of G'y, at the tolerance.
//
//   while (iteration.goes_on(limit)) { ... moves v and y ...; if (iteration.step_done()) break; }
class ConeIteration {
 public:
  struct Workspace {
    ConeProgram program;
    Vector v, y, s;  // s = G v - h
    Promise promise;
  };

  ConeIteration(Workspace& work, const Problem& problem, const SolveOptions& options, Solution& solution);
  // Builds the program and starts from the multipliers of an earlier frame. False where the answer is already written.
  bool begin();
  bool goes_on(int limit);
  // Counts the step, measures s and the residual and shows the iterate. True where that is good enough.
  bool step_done();
  double residual() const { return residual_; }
  const Deadline& deadline() const { return deadline_; }
  // Writes the last iterate, but for one that is written.
  void end();

 private:
  Workspace& work_;
  const Problem& problem_;
  const SolveOptions& options_;
  Solution& solution_;
  Deadline deadline_;
  double residual_ = 0;
};

}  // namespace zwang
