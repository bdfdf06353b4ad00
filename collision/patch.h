#pragma once

#include <span>

#include <zwang/collision/closest.h>
#include <zwang/collision/region.h>

namespace zwang::collision {

constexpr std::uint32_t patch_size = 64;  // triangles

// One point for all triangles of a small subtree, as `seen` from the shape in its region: the vertex that lies highest
// along n, the direction from the subtree's middle to the core. The plane through it keeps all of them from the core:
// `distance` is a lower bound for each, and the true distance of the vertex hardly more (a tenth of the stop distance
// and of the gap), or there is no answer. A palm or a finger on a fine mesh has tens of thousands of triangles within
// reach, which say the same thing. points: the subtree's corners.
bool stand_in(const Region& region, const Region::Seen& seen, std::span<const Vec3> points, double stop, Closest& out);

// The plane across the direction from `near`, a point of a patch, to the core, moved out to the highest of its corners:
// a lower bound of the distance. B's axes.
Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Vec3> points, const Vec3& near);

}  // namespace zwang::collision
