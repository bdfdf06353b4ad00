#pragma once

#include <functional>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// Where Newton begins of many unknowns: another method's way to where the rows with a force can be told.
struct NewtonStart {
  // accepted: z and lambda in the solution are within newton_inside of the answer. written: the problem is decided (or
  // said to be infeasible), or a promise is kept. limit: of time or steps, with the best iterate.
  enum class End { accepted, failed, limit, written };
  using Run = std::function<End(const Problem&, const SolveOptions&, const Deadline&, Solution&)>;
};
NewtonStart::Run inside_start();  // the interior point of `cone` on rows without friction (friction/inside_start.cpp)

}  // namespace zwang
