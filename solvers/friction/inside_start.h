#pragma once

#include <zwang/solvers/friction/cone_starts.h>
#include <zwang/solvers/newton_start.h>

namespace zwang {

// The interior point of `cone` on rows without friction.
class InsideStart {
 public:
  NewtonStart::End operator()(const Problem& problem, const SolveOptions& options, const Deadline& deadline,
                              Solution& solution);

 private:
  ConeStarts starts_;
};

}  // namespace zwang
