#pragma once

#include <span>
#include <vector>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>

namespace zwang::god {

// A convex body in place of a mesh: the hull of those of its vertices that lie outermost in some direction, 64 at most,
// rounded by 0.5 mm.
struct Hull {
  collision::Shape shape;  // about `middle`
  Vec3 middle, widths;     // m, of the box about the vertices
};
Hull hull_of(std::span<const Vec3> vertices);
Hull hull_of(const collision::Tree& mesh);

// 64 directions, spread evenly.
std::vector<Vec3> directions();

}  // namespace zwang::god
