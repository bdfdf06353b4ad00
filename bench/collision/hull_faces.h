#pragma once

#include <array>
#include <span>
#include <vector>

#include <zwang/core/model/pose.h>

namespace zwang {

// A triangle of corners whose plane has all others on one side: normal . p <= offset.
struct HullFace {
  Vec3 normal;  // unit, outward
  double offset;
  std::array<std::size_t, 3> corners;
};

// The faces of the convex hull of these corners (at most 64 by collision::Shape, so that all triples are tried); a face
// of more than three corners as each of its triples. Corners in one plane have it from both sides, in a line none.
std::vector<HullFace> hull_faces(std::span<const Vec3> corners);

}  // namespace zwang
