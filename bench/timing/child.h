#pragma once

#include <atomic>

#include <zwang/bench/timing/solve_service.h>
#include <zwang/core/process/child_process.h>

namespace zwang {

// A process of its own for foreign solvers, which may hang, print, crash or leak. It lives from call to call, so that
// repeated solves are as warm as native ones, and times itself (the pipe is never part of a time).
//
// It is forked, not executed: the suite starts no threads (repetitions run one after the other on one thread, BLAS is
// set to one thread), so the copy is a whole one at any moment, a solver registered only in a test is there too, and a
// new child needs no path to the program. Its stdin, stdout and stderr are /dev/null, it leaves no core file, ignores
// Ctrl-C (the parent decides) and dies with its parent.
//
// The deadline is on the child's own CPU time, time_limit plus a quarter and 0.2 s of grace for solvers that keep
// their limit by themselves; a child that sleeps is stopped after five times that on the wall clock.
class Child {
 public:
  explicit Child(MakeSolver make) : make_(std::move(make)) {}

  // The problem of the calls that follow; kept by the caller until the next load.
  void load(const Problem& problem);

  // Status::time_limit when the deadline stopped it, Status::crashed when it died; the next call starts a new child.
  // When *interrupted becomes true the child is stopped and the status is Status::unsolved.
  SolveReply run(const SolveRequest& call, const std::atomic<bool>* interrupted = nullptr);

 private:
  MakeSolver make_;
  const Problem* problem_ = nullptr;
  Peer peer_;
};

}  // namespace zwang
