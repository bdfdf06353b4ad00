#pragma once

#include <zwang/collision/mesh.h>

namespace zwang::meshes {

// Procedural parts of about `triangles` triangles, in metres, centred at the origin; the same on every machine up to
// the last digit of sin and cos. All but sheet() are closed.

collision::Mesh box(const Vec3& widths);                           // 12 triangles
collision::Mesh plate(const Vec3& widths, std::size_t triangles);  // a box whose two large faces (z) are finely cut
// A flat sheet of no thickness at z = 0.
collision::Mesh sheet(double width, double depth, std::size_t triangles);
// A plate with rows of square holes through it.
collision::Mesh perforated(const Vec3& widths, int holes, std::size_t triangles);
collision::Mesh pipe(double radius, double wall, double length, std::size_t triangles);   // along z
collision::Mesh gear(double radius, double thickness, int teeth, std::size_t triangles);  // along z
collision::Mesh bumpy_sphere(double radius, double bump, int waves, std::size_t triangles);
// Long thin triangles (1 : 10^4) fanned over a disc of radius `radius` at z = 0, doubled at `thickness` below.
collision::Mesh slivers(double radius, double thickness, std::size_t triangles);

}  // namespace zwang::meshes
