#pragma once

#include <optional>
#include <span>

#include <zwang/core/problem/problem.h>

namespace zwang {

// A solution of the law that the problem states, in rationals: of these stored doubles, without rounding, and without a
// question of what is independent of what. The last witness: small problems whose rows depend on each other or
// contradict each other but for 2^-50, and answers at the edge of a cone. It shares no code with the other proofs.
//
// What is guessed in doubles, rationals prove. Of z as it is given, of what polishing it ends at, of both in fewer
// digits: forces with J'lambda = M (z - z_u), each contact's along the edges that its motion leaves it; a basis of them
// is solved for, and the others stay where the guess has them. Of contacts with one tangent or none, where forces are
// sums of edges of the cones, also z itself: edges that push make rows hold, and these make a linear system
// (Caratheodory: edges that depend on each other need not push). The edges that the forces use are tried first, then,
// where they are few, all sets of them.
struct ExactPoint {
  double distance = 0, size = 0;  // |z - z'|_M and |z'|_M of the solution z', to a few roundings
};
std::optional<ExactPoint> exact_point(const Problem& problem, const Vector& z, std::span<const Vector> near,
                                      std::span<const Vector> forces);

}  // namespace zwang
