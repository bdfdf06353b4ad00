#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang::collision {

// A triangle soup with shared corners, in metres, in its own axes. Triangles have two sides; nothing needs to be
// closed.
struct Mesh {
  std::vector<Vec3> vertices = {};
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};

// What clean() changed and found.
struct MeshReport {
  std::size_t triangles_read = 0;
  std::size_t welded = 0;                        // vertices merged into an earlier one
  std::size_t degenerate = 0;                    // triangles dropped: no area
  std::size_t repeated = 0;                      // triangles dropped: the same three corners again
  std::size_t boundary_edges = 0;                // of one triangle
  std::size_t non_manifold_edges = 0;            // of three or more
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // m, the bounding box
};

// "1,234 triangles, 12 degenerate dropped, ..." in one line.
std::string to_string(const MeshReport& report);

// Welds vertices that are equal or nearer than `weld` [m] along every axis (to the cell of a grid of that width and its
// neighbours), drops triangles without area and repeated ones, forgets vertices that no triangle uses, and counts the
// edges that are not shared by exactly two triangles. Order is kept. Throws std::invalid_argument for an index out of
// range or a vertex that is not finite, naming the first, and for a mesh without a triangle left.
MeshReport clean(Mesh& mesh, double weld = 0);

}  // namespace zwang::collision
