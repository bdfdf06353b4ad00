#pragma once

#include <zwang/collision/mesh.h>

namespace zwang::meshes {

// Parts as CAD systems tessellate them: flat faces and rolled-up surfaces in strips that run across the whole part, as
// narrow as the points of a fillet lie apart. Aspect ratio of a triangle: its longest edge over the height on it. All
// closed, in metres, centred about the z axis from z = 0 up, the same on every machine up to the last digit of sin and
// cos.

// A gear, or with a large thickness a splined shaft. Each tooth has four corners rounded by `fillet`, and `points`
// points. The faces are strips from the bore to the rim, the walls have `layers` of strips along the axis.
collision::Mesh sliver_gear(double radius, double thickness, int teeth, int points, int layers, double fillet);

// A trapezoidal thread, its corners rounded by `fillet`, of `steps` strips a turn along the helix; ends fanned.
collision::Mesh sliver_thread(double radius, double pitch, int turns, int steps, int points, double fillet);

// A plate whose faces and two of its sides are strips along x: their boxes along the axes are as tight as any.
collision::Mesh sliver_plate(const Vec3& widths, int strips);

// From a square with rounded corners of `points` points below to a square turned by 45 degrees above: all points of a
// corner below are joined to the same one above.
collision::Mesh sliver_loft(double radius, double height, int points, double fillet);

// The same surface as careless programs write it: triangles repeated with corners 1e-10 m off, T-junctions, triangles
// of next to no area, and one large triangle under everything.
collision::Mesh spoiled(const collision::Mesh& mesh);

// The largest aspect ratio, and the median one.
struct Aspects {
  double median = 0, largest = 0;
};
Aspects aspects(const collision::Mesh& mesh);

}  // namespace zwang::meshes
