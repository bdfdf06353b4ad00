#pragma once

#include <zwang/bench/timing/solve_service.h>

namespace zwang {

void fields(auto visit, same_but_const<SolveRequest> auto& x) {
  visit(x.solver, x.tolerance, x.time_limit, x.max_iterations, x.solves, x.fresh, x.warm_up, x.observe, x.warm);
}
void fields(auto visit, same_but_const<SolveReply> auto& x) {
  visit(x.solution, x.seconds, x.prepare_s, x.allocations, x.iterates);
}

}  // namespace zwang
