#pragma once

#include <span>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>

namespace zwang::collision {

// The nearest points of two convex sets A and B.
struct Closest {
  double distance = 0;          // m, never more than the true distance; 0 when they touch or overlap
  Vec3 normal = Vec3::UnitX();  // unit, from B to A
  Vec3 on_b = Vec3::Zero();     // the nearest point of B
};

// Between the convex hulls of two sets of points (Gilbert, Johnson & Keerthi 1988). `distance` is the separation along
// `normal`. Any unit vector gives a lower bound: an iteration that stalls gives a smaller distance, never a larger one.
// (FCL's and libccd's GJK promise no such bound.)
Closest closest(std::span<const Vec3> a, std::span<const Vec3> b);

// Between the core of a shape and a triangle, both in the shape's axes; exact to rounding, in closed form where the
// nearest features allow it. Beyond `reach` [m] any lower bound >= reach may come back.
Closest closest(const Shape& shape, const Triangle& triangle, double reach);

// The point of a triangle nearest to p.
Vec3 nearest_point(const Triangle& triangle, const Vec3& p);

}  // namespace zwang::collision
