#pragma once

#include <optional>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// All solutions of Coulomb's law on a problem of at most six contacts with one tangent each (or none), in rationals:
// each choice of modes (open, stick, slide to either side) is a linear system, solved without rounding.
struct PlanarSolutions {
  std::vector<Vector> z = {};  // distinct, each rounded once
  bool continuum = false;      // some choice of modes has more than one z
};

// Empty where the problem has more contacts, contacts with two tangents, a singular M, or rows that depend on each
// other in more than four ways.
std::optional<PlanarSolutions> enumerate_planar(const Problem& problem);

}  // namespace zwang
