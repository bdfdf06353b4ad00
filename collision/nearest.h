#pragma once

#include <optional>
#include <span>

#include <zwang/collision/tree.h>

namespace zwang::collision {

// Points below a plane, or less than `tolerance` above it, are hidden: normal . x <= offset + tolerance.
struct Plane {
  static constexpr double tolerance = 2e-7;  // m; nodes are rounded outward by less
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;  // m

  bool hides(const Vec3& p) const { return normal.dot(p) <= offset + tolerance; }
};

struct NearestPoint {
  double distance = 0;         // m
  Vec3 point = Vec3::Zero();   // of the mesh
  std::uint32_t triangle = 0;  // in the tree's order
};

// The point of a mesh nearest to `p` (its axes), exact to rounding, if one is nearer than `reach` [m] and not hidden by
// any plane. The nearest point, then the nearest that the first one's plane does not hide, and so on, are what a sphere
// may hit: a few points, however fine the mesh is, with only one on a flat floor.
std::optional<NearestPoint> nearest(const Tree& tree, const Vec3& p, double reach, std::span<const Plane> hidden = {});

}  // namespace zwang::collision
