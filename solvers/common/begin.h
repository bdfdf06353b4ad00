#pragma once

#include <string>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/common/whiten.h>

namespace zwang {

// How a solver begins: the solution reset, and the unit rows of the problem (whiten.h, unit_rows.h). False where these
// are the answer already, which is then written: M not positive definite, or a zero row that cannot hold.
template <class Rows>
bool begin(Rows& rows, const Problem& problem, const Deadline& deadline, Solution& solution) {
  if (!rows.build(problem, deadline)) {
    solution.reset(0, 0);
    solution.status = Status::bad_input;
    solution.message = "M is not positive definite";
    return false;
  }
  if (rows.conflict >= 0) {
    solution.reset(0, 0);
    solution.status = Status::infeasible;
    zero_row_certificate(problem, rows.conflict, solution.zero_certificate(problem.rows()));
    solution.message.append("row ").append(std::to_string(rows.conflict)).append(" is zero and cannot hold");
    return false;
  }
  solution.reset(problem.size(), problem.rows());
  return true;
}

}  // namespace zwang
