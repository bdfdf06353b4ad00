#pragma once

#include <algorithm>
#include <span>

#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::collision {

// Which boxes and triangles of a mesh (B) may lie within a distance of a convex core (A) or of its sweep: a bounding
// box of the core in B's axes and one in A's axes. The second is the tighter one for a long finger that lies oblique.
struct Region {
  Pose<double> a_in_b;
  Eigen::AlignedBox3d box, local;  // in B's axes, in A's

  const Shape& shape;

  Region(const Shape& a, const Pose<double>& at, double margin) : a_in_b(at), shape(a) { include(at, margin); }
  void include(const Pose<double>& at, double margin) {
    const Vec3 room = Vec3::Constant(margin);
    for (const Vec3& corner : shape.corners()) {
      const Vec3 p = at * corner, q = a_in_b.rotation.transpose() * (p - a_in_b.position);
      box.extend({p - room, p + room});
      local.extend({q - room, q + room});
    }
  }

  // The bounding box of a node's box in A's axes: its middle and half widths.
  struct LocalBox {
    Vec3 at, half;
  };
  bool misses(const TreeNode& node, LocalBox& seen) const {
    Vec3 middle, half;
    for (int k = 0; k < 3; ++k) {
      const double l = node.low[static_cast<std::size_t>(k)], h = node.high[static_cast<std::size_t>(k)];
      if (l > box.max()[k] || h < box.min()[k]) return true;
      middle[k] = (l + h) / 2 - a_in_b.position[k];
      half[k] = (h - l) / 2;
    }
    for (int k = 0; k < 3; ++k) {
      const auto axis = a_in_b.rotation.col(k);
      seen.at[k] = axis.dot(middle), seen.half[k] = axis.cwiseAbs().dot(half);
      if (seen.at[k] - seen.half[k] > local.max()[k] || seen.at[k] + seen.half[k] < local.min()[k]) return true;
    }
    return false;
  }
  // Along the slab's axes.
  bool misses(const Slab& slab) const {
    const Vec3 half = local.sizes() / 2, middle = a_in_b * local.center();
    const Mat3 back = slab.axes.transpose();
    const Vec3 at = back * middle, wide = (back * a_in_b.rotation).cwiseAbs() * half;
    return (at + wide - slab.low).minCoeff() < 0 || (slab.high - at + wide).minCoeff() < 0;
  }
  bool misses(const Triangle& of_a) const {
    const auto& [a, b, c] = of_a.corner;
    for (int k = 0; k < 3; ++k)
      if (std::min({a[k], b[k], c[k]}) > local.max()[k] || std::max({a[k], b[k], c[k]}) < local.min()[k]) return true;
    return false;
  }
};

constexpr std::uint32_t patch_size = 64;  // triangles

// One plane in place of all triangles of a small subtree (a patch), whose box in A's axes is `box`: through the vertex
// that is highest along n, the direction from the patch's middle to the core. It separates all of them from the core:
// `distance` is a lower bound for each. Returns false unless the true distance of that vertex is larger by at most a
// tenth of the stop distance and of the gap. A palm on a fine mesh has tens of thousands of triangles within reach that
// all give the same contact. points: the patch's corners.
bool patch_plane(const Region& region, const Region::LocalBox& box, std::span<const Vec3> points, double stop,
                 Closest& out);

// The plane with the direction from `near`, a point of a patch, to the core as its normal, through the highest of the
// patch's corners: a lower bound of the distance. B's axes.
Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Vec3> points, const Vec3& near);

// Of slivers side by side, whose corners are far off to the side: the plane across the nearest points of the core and
// of a subtree's triangle that is nearest as far as boxes tell, moved up to the highest corner of all of them, of more
// than 256 to that of their box. Over what bulges toward the core such a plane is exact, over however many. on_b is on
// the plane, beside the core. B's axes. `reach`: as for closest().
struct PlaneOver : Closest {
  double most = 0;  // m, the distance of that one triangle: an upper bound, unless it is beyond reach
};
PlaneOver plane_over(const Shape& shape, const Pose<double>& place, const Tree& tree, std::size_t node, double reach);

}  // namespace zwang::collision
