#include <zwang/collision/narrow_phase/face_contacts.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zwang::collision {
namespace {

// The plane of the common normal n.
struct Plane {
  Vec3 n, u, v;
  double x(const Vec3& p) const { return u.dot(p); }
  double y(const Vec3& p) const { return v.dot(p); }
};

// A convex polygon, projected along the normal: corners counter-clockwise, with their heights. A polygon of 64 corners
// clipped by another of 64 has at most 128.
struct Outline {
  int count = 0;
  std::array<Vec3, 129> p;
  void add(const Vec3& q) {
    if (count < static_cast<int>(p.size())) p[static_cast<std::size_t>(count++)] = q;
  }
  const Vec3& operator[](int k) const { return p[static_cast<std::size_t>(k % count)]; }
};

// The convex hull of the projected points (Andrew's monotone chain).
Outline hull(Outline& points, const Plane& plane) {
  const auto end = points.p.begin() + points.count;
  std::sort(points.p.begin(), end, [&](const Vec3& a, const Vec3& b) {
    return plane.x(a) != plane.x(b) ? plane.x(a) < plane.x(b) : plane.y(a) < plane.y(b);
  });
  if (points.count < 3) return points;
  Outline out;
  const auto turn = [&](const Vec3& a, const Vec3& b, const Vec3& c) { return plane.n.dot((b - a).cross(c - a)); };
  const auto walk = [&](int first, int step) {
    const int base = out.count;
    for (int k = first; k >= 0 && k < points.count; k += step) {
      while (out.count >= base + 2 && turn(out[out.count - 2], out[out.count - 1], points[k]) <= 1e-12) --out.count;
      out.add(points[k]);
    }
    --out.count;  // the other half begins with it
  };
  walk(0, 1);
  walk(points.count - 1, -1);
  return out;
}

// The polygon clipped by a line (Sutherland & Hodgman 1974).
Outline clipped(const Outline& outline, const Vec3& at, const Vec3& inward) {
  Outline out;
  for (int k = 0; k < outline.count; ++k) {
    const Vec3 &p = outline[k], &q = outline[k + 1];
    const double in = inward.dot(p - at), next = inward.dot(q - at);
    if (in >= 0) out.add(p);
    if ((in > 0 && next < 0) || (in < 0 && next > 0)) out.add(p + in / (in - next) * (q - p));
  }
  return out;
}

Outline clipped(Outline outline, const Outline& by, const Plane& plane) {
  for (int k = 0; k < by.count && outline.count > 0; ++k)
    outline = clipped(outline, by[k], plane.n.cross(by[k + 1] - by[k]));
  return outline;
}

}  // namespace

void face_contacts(const Shape& a, const Pose<double>& a_in_b, const Shape& b, const Closest& nearest, double reach,
                   FaceContacts& out) {
  out.count = 0;
  if (a.corners().size() < 2 || b.corners().size() < 2 || !(nearest.distance > 0)) return;
  const Plane plane{nearest.normal, nearest.normal.unitOrthogonal(),
                    nearest.normal.cross(nearest.normal.unitOrthogonal())};
  const Vec3& n = plane.n;
  const double within = reach + a.radius() + b.radius();
  const double low = n.dot(nearest.on_b) + nearest.distance, high = n.dot(nearest.on_b);
  const double room = within - nearest.distance + 1e-12;

  Outline of_a, of_b;
  std::array<Vec3, 64> corners;
  for (std::size_t k = 0; k < a.corners().size(); ++k) {
    corners[k] = a_in_b * a.corners()[k];
    if (n.dot(corners[k]) <= low + room) of_a.add(corners[k]);
  }
  for (const Vec3& q : b.corners())
    if (n.dot(q) >= high - room) of_b.add(q);
  if (of_a.count < 2 || of_b.count < 2) return;
  of_a = hull(of_a, plane), of_b = hull(of_b, plane);

  // The area's corners are points of A, or of B where B has an edge on a face of A.
  const bool on_b = of_b.count == 2 && of_a.count > 2;
  Outline area;
  if (on_b) {
    area = clipped(of_b, of_a, plane);
  } else if (of_b.count > 2) {
    area = clipped(of_a, of_b, plane);
  } else {
    const Vec3 along = of_b[1] - of_b[0], other = of_a[1] - of_a[0];
    if (along.cross(other).norm() > 0.5 * along.norm() * other.norm()) return;
    area = clipped(clipped(of_a, of_b[0], along), of_b[1], -along);
  }

  const Vec3 known = on_b ? nearest.on_b : Vec3(nearest.on_b + nearest.distance * n);
  std::array<Vec3, 6> taken;
  int count = 0;
  for (int k = 0; k < 6 && area.count > 0; ++k) {
    const double angle = k * std::numbers::pi / 3;
    const Vec3 direction = std::cos(angle) * plane.u + std::sin(angle) * plane.v;
    const Vec3 p = *std::max_element(area.p.begin(), area.p.begin() + area.count,
                                     [&](const Vec3& x, const Vec3& y) { return direction.dot(x) < direction.dot(y); });
    const auto same = [&](const Vec3& q) { return (p - q).squaredNorm() < 1e-8; };
    if (same(known) || std::any_of(taken.begin(), taken.begin() + count, same)) continue;
    taken[static_cast<std::size_t>(count++)] = p;
    const Closest c = on_b ? closest(std::span<const Vec3>(corners.data(), a.corners().size()), {&p, 1})
                           : closest({&p, 1}, b.corners());
    if (c.distance > 0 && c.distance <= within) out.at[static_cast<std::size_t>(out.count++)] = c;
  }
}

}  // namespace zwang::collision
