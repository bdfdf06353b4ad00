#pragma once

#include <string>

#include <zwang/collision/tree.h>

namespace zwang::god {

// A mesh as a page shows it: simplified, corners on a grid of 65,536 steps over its box, normals of the full mesh.
// Encoded by meshoptimizer: vertices of 12 bytes (position 3 x u16, normal octahedral 2 x i16, 0) and u32 indices.
struct DisplayMesh {
  std::size_t vertices = 0, indices = 0;  // indices: 3 a triangle
  std::size_t full = 0;                   // triangles of the mesh itself
  double error = 0;                       // m, of the simplification, as meshoptimizer estimates it
  Vec3 low = Vec3::Zero();                // m
  double size = 1;                        // m, of 65,535 steps
  std::string vertex_bytes = {}, index_bytes = {};
};

// At most about `triangles` of them stay.
DisplayMesh display_mesh(const collision::Tree& tree, std::size_t triangles);

}  // namespace zwang::god
