#pragma once

#include <span>
#include <vector>

#include <zwang/core/problem/solver.h>

namespace zwang {

// Many problems, each solved by itself, on several threads at once: parameter sweeps, learning loops, scenes that share
// nothing. Every thread has a solver of its own, a copy of the one given, and takes the next problem as soon as it is
// done with one; problems of one topology leave it nothing to look up or allocate after the first.
//
// A second solve gives the same bits as a first one, so an answer depends neither on its place in the batch nor on the
// number of threads: it has the bits of solver.solve(problem, options, solution). For solvers of this project; foreign
// ones (SolverEntry::foreign) need not be made for threads.
class BatchSolver {
 public:
  // threads: at least 1, or 0 for as many as the machine runs at once.
  explicit BatchSolver(const AnySolver& solver, int threads = 0);
  int threads() const { return static_cast<int>(solvers_.size()); }

  // solutions: as many as problems, their storage reused. Options hold for each problem; an observer, which several
  // threads would call, is refused (std::invalid_argument), and so are problems whose parts do not fit together, the
  // first of them by its number, once all threads are done.
  void solve(std::span<const Problem> problems, const SolveOptions& options, std::span<Solution> solutions);

 private:
  std::vector<AnySolver> solvers_;
};

}  // namespace zwang
