#include <zwang/collision/shape.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace zwang::collision {

Shape::Shape(Core core, std::vector<Vec3> corners, double radius)
    : core_(core), radius_(radius), corners_(std::move(corners)) {
  if (!(radius > 0) || !std::isfinite(radius)) throw std::invalid_argument("a shape needs a positive radius");
  if (corners_.empty() || corners_.size() > 64) throw std::invalid_argument("a hull has 1 to 64 points");
  for (const Vec3& p : corners_) {
    if (!p.allFinite()) throw std::invalid_argument("a shape's size is not finite");
    reach_ = std::max(reach_, p.norm());
    half_ = half_.cwiseMax(p.cwiseAbs());
  }
}

Shape Shape::sphere(double radius) { return {Core::point, {Vec3::Zero()}, radius}; }

Shape Shape::capsule(double length, double radius) {
  if (length < 0) throw std::invalid_argument("a capsule's length is negative");
  return {Core::segment, {Vec3(0, -length / 2, 0), Vec3(0, length / 2, 0)}, radius};
}

Shape Shape::rounded_box(const Vec3& widths, double rounding) {
  const Vec3 h = widths / 2 - Vec3::Constant(rounding);
  if (!(h.minCoeff() >= 0)) throw std::invalid_argument("a box is thinner than its rounding");
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back(k & 1 ? h.x() : -h.x(), k & 2 ? h.y() : -h.y(), k & 4 ? h.z() : -h.z());
  return {Core::box, std::move(corners), rounding};
}

Shape Shape::hull(std::span<const Vec3> points, double radius) {
  return {Core::hull, {points.begin(), points.end()}, radius};
}

}  // namespace zwang::collision
