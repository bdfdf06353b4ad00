#pragma once

#include <limits>

#include <zwang/core/referee/bounds.h>

namespace zwang {

// A ball that holds the true motion, proven from the stored doubles.
struct Proof {
  using Rows = DistanceBound::Rows;
  Rows rows = Rows::open;
  ExtendedVector d = {};                                        // its centre, d = z - z_u
  double radius = infinity;                                     // |d - d*|_M <= radius
  double farther_than = 0;                                      // when infeasible: what any feasible |d| would exceed
  double sigma_min = std::numeric_limits<double>::quiet_NaN();  // lower bound for the rows that hold
};

// Finds an answer from the guess and proves how far it is from the true one. lambda may be null. `motion`: s, of the
// whole problem where this is a part of one; rows contradict each other where no z is within 1e8 of it.
Proof prove_answer(const ScaledProblem& scaled, const ExtendedVector& guess_d, const ExtendedVector* guess_lambda,
                   double motion);

}  // namespace zwang
