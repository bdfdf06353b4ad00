#pragma once

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// The active row whose multiplier reaches zero first as the entering one grows: after `step`. row: its place, or -1.
template <class Scalar>
struct Blocking {
  Index row = -1;
  Scalar step{};
};

// The dual active-set method of Goldfarb & Idnani (Math. Programming 27, 1983). (y, u) is always the optimum of the
// active rows with u >= 0; each row that enters raises the dual objective, after as many active rows have left as its
// multiplier would turn negative.
//
// One climb for all representations of the rows and all factorizations of the active ones. A policy has
//
//   choose()               the violated row that enters next, or -1
//   split(p)               the length of what row p has outside the active rows, g_p = sum r_j g_j + remainder
//   is_dependent(length)   whether that is nothing but rounding
//   violation(p)           h_p - g_p y
//   is_satisfied(p, v)     whether rounding explains the violation v of a dependent row
//   blocking()             see above
//   contradicts(p, length) no active row can leave for the dependent row p: whether that proves a contradiction
//   retire(p)              p is left out until a row has entered
//   move(step, dependent)  u -= step r, and y += step remainder unless p is dependent
//   drop(j)                the j-th active row leaves
//   append(p, u, length)   the row that was split enters with the multiplier u
//   is_stuck()             the factorization cannot go on
//
// entered() is called after each row that enters. Ends solved, infeasible, at a limit or, where it is stuck, as a
// numerical failure.
template <class Policy, class Entered>
Status dual_climb(Policy& rows, int& iterations, int most_iterations, const Deadline& deadline, Entered&& entered) {
  using Scalar = decltype(rows.split(0));
  for (Index p = rows.choose(); p >= 0; p = rows.choose()) {
    Scalar multiplier(0);
    for (bool decided = false; !decided;) {
      if (iterations >= most_iterations) return Status::iteration_limit;
      if (deadline.passed()) return Status::time_limit;
      ++iterations;
      const Scalar length = rows.split(p), violation = rows.violation(p);
      if (rows.is_stuck()) return Status::numerical_failure;
      const Blocking<Scalar> block = rows.blocking();
      const bool dependent = rows.is_dependent(length);
      if (dependent) {
        const bool satisfied = rows.is_satisfied(p, violation);
        if (!satisfied && block.row < 0 && rows.contradicts(p, length)) return Status::infeasible;
        if (satisfied || block.row < 0) {
          rows.retire(p);
          break;
        }
      }
      const Scalar full = dependent ? Scalar(0) : Scalar(violation / (length * length));
      decided = block.row < 0 || (!dependent && !(block.step < full));
      const Scalar step = decided ? full : block.step;
      rows.move(step, dependent);
      multiplier += step;
      if (decided)
        rows.append(p, multiplier, length);
      else
        rows.drop(block.row);
      if (rows.is_stuck()) return Status::numerical_failure;
      if (decided) entered();
    }
  }
  return Status::solved;
}

}  // namespace zwang
