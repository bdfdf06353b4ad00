#pragma once

#include <array>

#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::collision {

// Where two shapes touch with their faces, the nearest points alone do not keep them from rotating into each other.
// These are pairs of points at the corners of the area in which the faces overlap.
struct FaceContacts {
  int count = 0;
  std::array<Closest, 6> at = {};
};

// nearest: the nearest points of the two cores, which must be apart, in B's axes. Each pair is exact: a point at a
// corner or edge of one core against the whole other core, with a gap of at most `reach` [m]. None where a vertex meets
// a face or two edges cross: there the nearest pair is enough.
void face_contacts(const Shape& a, const Pose<double>& a_in_b, const Shape& b, const Closest& nearest, double reach,
                   FaceContacts& out);

}  // namespace zwang::collision
