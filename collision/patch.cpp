#include "collision/patch.h"

#include <limits>

namespace zwang::collision {
namespace {

// The corner that lies highest along `up`, and its triangle.
struct Highest {
  double height = -std::numeric_limits<double>::infinity();
  Vec3 corner;
  std::uint32_t triangle = 0;

  Highest(const Vec3& up, std::span<const Triangle> triangles) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (const Vec3& p : triangles[t].corner)
        if (const double here = up.dot(p); here > height) height = here, corner = p, triangle = t;
  }
};

}  // namespace

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
  const Highest highest(up, triangles);
  winner = first + highest.triangle;
  out.on_b = highest.corner;
  out.normal = up;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest.height - up.dot(region.a_in_b.position));
  const Vec3 local = region.a_in_b.rotation.transpose() * (out.on_b - region.a_in_b.position);
  const double gap = out.distance - shape.radius();
  return gap > stop / 2 && (local - shape.nearest(local)).norm() - out.distance <= (stop + gap) / 10;
}

Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Triangle> triangles,
                      const Vec3& near) {
  const Vec3 local = place.rotation.transpose() * (near - place.position);
  const Vec3 n = (shape.nearest(local) - local).normalized();
  Closest out{.normal = place.rotation * n};
  const Highest highest(out.normal, triangles);
  out.on_b = highest.corner;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest.height - out.normal.dot(place.position));
  return out;
}

}  // namespace zwang::collision
