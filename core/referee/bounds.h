#pragma once

#include <limits>
#include <string>

#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// How far a motion d = z - z_u is from the true one, found without a reference; in scaled units.
struct DistanceBound {
  enum class Rows { open, feasible, infeasible };  // what could be proven about the rows

  double upper = infinity;  // |z - z*|_M <= upper
  double lower = 0;         // |z - z*|_M >= lower
  double least_norm = 0;    // least_norm <= |z*|_M <= greatest_norm
  double greatest_norm = infinity;
  double sigma_min = std::numeric_limits<double>::quiet_NaN();
  std::string method = {};  // "active set", "opening", "rationals" or "gap"; "" when there is no bound
  Rows rows = Rows::open;
};

// lambda: multipliers in scaled units, or null. docs/referee.md says when which bound is valid.
DistanceBound bound_distance(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector* lambda);

}  // namespace zwang
