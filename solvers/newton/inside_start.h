#pragma once

#include <memory>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

class ConeStarts;

// The interior point of `cone` (solvers/friction/cone_starts.h) on rows without friction, up to where the rows with a
// force can be told. Behind a pointer: who uses Newton need not read how it goes.
class InsideStart {
 public:
  InsideStart();
  InsideStart(const InsideStart&);  // storage of its own; what a solve leaves is not copied
  InsideStart& operator=(const InsideStart&) { return *this; }
  ~InsideStart();

  // near: z and lambda in the solution are within newton_inside of the answer. written: the problem is decided (or said
  // to be infeasible), or a promise is kept. limit: of time or steps, with the best iterate.
  enum class End { near, failed, limit, written };
  End run(const Problem& problem, const SolveOptions& options, const Deadline& deadline, Solution& solution);

 private:
  std::unique_ptr<ConeStarts> starts_;
};

}  // namespace zwang
