#pragma once

#include <limits>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>
#include <zwang/core/model/pose.h>

namespace zwang::collision {

// Which boxes and triangles of a mesh (B) may lie within a distance of a convex core or of its sweep: a box about them
// in B's axes and one in the axes of A. The second is what counts for a long finger that lies askew.
struct Region {
  Pose<double> a_in_b;
  Vec3 low, high;              // B's axes
  Vec3 local_low, local_high;  // A's axes

  const Shape& shape;

  Region(const Shape& a, const Pose<double>& at, double margin) : a_in_b(at), shape(a) {
    local_low = low = Vec3::Constant(std::numeric_limits<double>::infinity());
    local_high = high = -low;
    include(at, margin);
  }
  void include(const Pose<double>& at, double margin) {
    for (const Vec3& corner : shape.corners()) {
      const Vec3 p = at * corner, q = a_in_b.rotation.transpose() * (p - a_in_b.position);
      low = low.cwiseMin(p - Vec3::Constant(margin));
      high = high.cwiseMax(p + Vec3::Constant(margin));
      local_low = local_low.cwiseMin(q - Vec3::Constant(margin));
      local_high = local_high.cwiseMax(q + Vec3::Constant(margin));
    }
  }

  // A node's box in the axes of A: its middle and half widths.
  struct Seen {
    Vec3 at, half;
  };
  bool misses(const TreeNode& node, Seen& seen) const {
    Vec3 middle, half;
    for (int k = 0; k < 3; ++k) {
      const double l = node.low[static_cast<std::size_t>(k)], h = node.high[static_cast<std::size_t>(k)];
      if (l > high[k] || h < low[k]) return true;
      middle[k] = (l + h) / 2 - a_in_b.position[k];
      half[k] = (h - l) / 2;
    }
    for (int k = 0; k < 3; ++k) {
      const auto axis = a_in_b.rotation.col(k);
      seen.at[k] = axis.dot(middle), seen.half[k] = axis.cwiseAbs().dot(half);
      if (seen.at[k] - seen.half[k] > local_high[k] || seen.at[k] + seen.half[k] < local_low[k]) return true;
    }
    return false;
  }
  bool misses(const Triangle& local) const {
    const auto& [a, b, c] = local.corner;
    for (int k = 0; k < 3; ++k)
      if (std::min({a[k], b[k], c[k]}) > local_high[k] || std::max({a[k], b[k], c[k]}) < local_low[k]) return true;
    return false;
  }
};

}  // namespace zwang::collision
