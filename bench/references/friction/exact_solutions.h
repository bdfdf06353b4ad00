#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// All solutions of a small problem in rationals, under the law it states: without friction, or with one tangent a
// contact. A force is a sum of edges of the cones; each choice of edges is a linear system, and edges that depend on
// each other need not be tried (Caratheodory). Shares no code with the referee, the other references or a solver.
class ExactSolutions {
 public:
  struct Rounded {
    Vector z, lambda;
  };
  struct Range {
    double low, high;
  };

  // Enumerates. 4 choices a contact with friction, 2 one without; all equality rows push.
  explicit ExactSolutions(const Problem& problem);
  // Of a planted z, with any number of tangents. `complete` under the convex law, and under Coulomb's where
  // z -> Z(sigma(z)) contracts.
  ExactSolutions(const Problem& problem, const Vector& z, const Vector& lambda);

  bool complete() const { return complete_; }  // no solution is missing: there is no continuum of them either
  const std::vector<Rounded>& solutions() const { return solutions_; }
  // Of choices whose equations hold, and not all that is asked for beside them: wrong unless equal to a solution.
  const std::vector<Rounded>& misses() const { return misses_; }
  // What is known of the distance of z to the nearest solution z', relative to max(|z_u|, |z'|), in the M-norm.
  Range error(const Vector& z) const;
  // |z' - z_u| / |z_u| of the nearest solution; +Inf where none is known.
  double motions() const;

 private:
  struct Data;
  std::shared_ptr<Data> data_;
  bool complete_ = true;
  std::vector<Rounded> solutions_ = {}, misses_ = {};
};

// Empty where the problem has more than six contacts, or contacts with two tangents.
std::optional<ExactSolutions> enumerate_planar(const Problem& problem);

}  // namespace zwang
