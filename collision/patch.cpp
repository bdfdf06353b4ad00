#include "collision/patch.h"

#include <algorithm>

namespace zwang::collision {

bool stand_in(const Region& region, const Region::Seen& seen, std::span<const Triangle> triangles, std::uint32_t first,
              double stop, Closest& out, std::uint32_t& winner) {
  const Shape& shape = region.shape;
  const Vec3 core = shape.nearest(seen.at), apart = core - seen.at;
  const double length = apart.norm();
  if (length <= shape.radius()) return false;
  const double slack = (stop + length - shape.radius()) / 10;
  const Vec3 n = apart / length, up = region.a_in_b.rotation * n;
  // Off to the side by e, a vertex is e^2 / (2 length) farther than its plane; not under a flat side.
  const bool beside = ((apart.array() != 0).count() > 1);
  if (beside && seen.half.squaredNorm() > 8 * length * slack) return false;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const Vec3& p : triangles[t].corner)
      if (const double here = up.dot(p); here > highest) highest = here, out.on_b = p, winner = first + t;
  out.normal = up;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest - up.dot(region.a_in_b.position));
  const Vec3 local = region.a_in_b.rotation.transpose() * (out.on_b - region.a_in_b.position);
  const double gap = out.distance - shape.radius();
  return gap > stop / 2 && (local - shape.nearest(local)).norm() - out.distance <= (stop + gap) / 10;
}

Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Triangle> triangles,
                      const Vec3& near) {
  const Vec3 local = place.rotation.transpose() * (near - place.position);
  const Vec3 n = (shape.nearest(local) - local).normalized();
  Closest out{.normal = place.rotation * n};
  double highest = -std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles)
    for (const Vec3& p : t.corner)
      if (const double here = out.normal.dot(p); here > highest) highest = here, out.on_b = p;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest - out.normal.dot(place.position));
  return out;
}

}  // namespace zwang::collision
