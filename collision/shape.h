#pragma once

#include <span>
#include <vector>

#include <zwang/core/model/pose.h>

namespace zwang::collision {

// A convex core swept by a sphere: all points within `radius` of the core, in the body's axes. The radius keeps normals
// defined: as long as surfaces overlap by less than a radius the cores are apart, and the normal is the direction
// between their nearest points, also at edges and corners.
enum class Core : unsigned char { point, segment, box, hull };

class Shape {
 public:
  // A radius (rounding) must be positive, lengths not negative, everything finite: std::invalid_argument otherwise.
  static Shape sphere(double radius);
  static Shape capsule(double length, double radius);              // axis y; `length` between the centres of the caps
  static Shape rounded_box(const Vec3& widths, double rounding);   // outer widths, each at least 2 * rounding
  static Shape hull(std::span<const Vec3> points, double radius);  // the convex hull of 1..64 points, swept

  Core core() const { return core_; }
  double radius() const { return radius_; }
  // The corners of the core.
  std::span<const Vec3> corners() const { return corners_; }
  // Half widths of the core: of a box, and of the box about any other core.
  const Vec3& half() const { return half_; }
  // The farthest corner from the body's origin.
  double reach() const { return reach_; }
  // The point of the core nearest to p (the body's axes). Of all cores but hulls.
  Vec3 nearest(const Vec3& p) const { return p.cwiseMax(-half_).cwiseMin(half_); }

 private:
  Shape(Core core, std::vector<Vec3> corners, double radius);

  Core core_;
  double radius_, reach_ = 0;
  Vec3 half_ = Vec3::Zero();
  std::vector<Vec3> corners_;
};

}  // namespace zwang::collision
