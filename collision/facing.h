#pragma once

#include <array>

#include <zwang/collision/closest.h>

namespace zwang::collision {

// Where two shapes lie side against side, their nearest points alone do not say what keeps them from turning into each
// other. These are pairs of points at the corners of the area in which the sides face each other.
struct Facing {
  int count = 0;
  std::array<Closest, 6> at = {};
};

// nearest: of the two cores, apart from each other, in B's axes. Each pair is exact: a point of one core, that a corner
// or an edge of it carries, against the whole other core; its gap is at most `reach` [m]. Nothing where a point meets a
// side or edges cross: there the nearest pair says it all.
void facing(const Shape& a, const Pose<double>& a_in_b, const Shape& b, const Closest& nearest, double reach,
            Facing& out);

}  // namespace zwang::collision
