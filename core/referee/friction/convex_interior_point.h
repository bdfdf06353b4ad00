#pragma once

#include <zwang/core/referee/friction/extended_symmetric.h>
#include <zwang/core/referee/friction/interior_point.h>
#include <zwang/core/referee/friction/lorentz_cone.h>

namespace zwang {

// The convex problem of slips sigma, of a problem without equality rows, in double-double throughout: primal-dual
// interior point with Nesterov-Todd scaling P and Mehrotra's steps, on the normal matrix M + J'P^2 J. That one is as
// large as the unknowns, and regular whatever rows depend on each other: where redundant rows disagree in their last
// digits, only so many digits show which of them hold. O(unknowns^3 + rows unknowns^2) an iteration, less where J is
// sparse.
class ConvexInteriorPoint {
 public:
  // inside: by how much every contact is to open beyond its cone, in unit rows: answers strictly inside.
  ConvexInteriorPoint(const ContactProblem& problem, const ExtendedVector& sigma, double inside = 0);

  // All iterates, the last the best. `keep_iterates` does not count.
  std::vector<InteriorAnswer> solve(const InteriorOptions& options);

 private:
  using Block = VectorX<DoubleDouble>;  // of one contact: rows N / mu, T1, T2
  using Blocks = std::vector<Block>;

  Blocks slack(const ExtendedVector& x) const;        // J x in the cones' units
  ExtendedVector multipliers(const Blocks& y) const;  // of the problem's rows
  void form(const std::vector<lorentz_cone::NesterovTodd<DoubleDouble>>& scaling);
  DoubleDouble longest(const Blocks& at, const Blocks& step) const;
  InteriorAnswer answer(const ExtendedVector& x, const Blocks& y, const Blocks& w) const;

  const ContactProblem& p_;
  std::vector<std::size_t> cones_;  // contacts
  Blocks unit_, q_;                 // what a row is multiplied by; -h with the lift
  ExtendedSymmetric normal_;
};

}  // namespace zwang
