#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <zwang/collision/closest.h>

namespace zwang::collision {
namespace {

// A corner of the difference A - B, and the corner of B it came from.
struct Corner {
  Vec3 w, b;
};

// The point of a simplex nearest to the origin: which corners carry it, with which weights.
struct Nearest {
  int count = 0;
  std::array<int, 3> corner = {};
  std::array<double, 3> weight = {};
  double length2 = std::numeric_limits<double>::infinity();
};

using Simplex = std::array<Corner, 4>;

void keep_nearer(Nearest& best, const Simplex& s, const Nearest& candidate) {
  Vec3 v = Vec3::Zero();
  for (int k = 0; k < candidate.count; ++k)
    v += candidate.weight[static_cast<std::size_t>(k)] *
         s[static_cast<std::size_t>(candidate.corner[static_cast<std::size_t>(k)])].w;
  if (const double length2 = v.squaredNorm(); length2 < best.length2) {
    best = candidate;
    best.length2 = length2;
  }
}

void on_segment(Nearest& best, const Simplex& s, int i, int j) {
  const Vec3& p = s[static_cast<std::size_t>(i)].w;
  const Vec3 d = s[static_cast<std::size_t>(j)].w - p;
  const double length2 = d.squaredNorm(), along = -p.dot(d);
  if (!(along > 0)) return keep_nearer(best, s, {1, {i}, {1}, 0});
  if (along >= length2) return keep_nearer(best, s, {1, {j}, {1}, 0});
  const double t = along / length2;
  keep_nearer(best, s, {2, {i, j}, {1 - t, t}, 0});
}

// Inside, or on one of the three edges.
void on_triangle(Nearest& best, const Simplex& s, int i, int j, int k) {
  const Vec3 &a = s[static_cast<std::size_t>(i)].w, &b = s[static_cast<std::size_t>(j)].w,
             &c = s[static_cast<std::size_t>(k)].w;
  const Vec3 n = (b - a).cross(c - a);
  const double area2 = n.squaredNorm();
  const double u = b.cross(c).dot(n), v = c.cross(a).dot(n), w = a.cross(b).dot(n);
  if (u > 0 && v > 0 && w > 0 && area2 > 0) {
    const double sum = u + v + w;
    keep_nearer(best, s, {3, {i, j, k}, {u / sum, v / sum, w / sum}, 0});
    return;
  }
  if (u <= 0 || area2 == 0) on_segment(best, s, j, k);
  if (v <= 0 || area2 == 0) on_segment(best, s, k, i);
  if (w <= 0 || area2 == 0) on_segment(best, s, i, j);
}

// False: the origin lies inside the tetrahedron.
bool on_tetrahedron(Nearest& best, const Simplex& s) {
  const Vec3 &a = s[0].w, &b = s[1].w, &c = s[2].w, &d = s[3].w;
  const double volume = (b - a).cross(c - a).dot(d - a);
  const double size = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm(), d.squaredNorm()});
  const bool flat = std::abs(volume) <= 1e-14 * size * std::sqrt(size);
  bool outside = false;
  const auto face = [&](int i, int j, int k, int other) {
    const auto at = [&](int x) -> const Vec3& { return s[static_cast<std::size_t>(x)].w; };
    const Vec3 n = (at(j) - at(i)).cross(at(k) - at(i));
    const double origin = -at(i).dot(n), fourth = (at(other) - at(i)).dot(n);
    if (flat || (fourth > 0) == (origin < 0)) {
      outside = true;
      on_triangle(best, s, i, j, k);
    }
  };
  face(0, 1, 2, 3);
  face(0, 1, 3, 2);
  face(0, 2, 3, 1);
  face(1, 2, 3, 0);
  return outside;
}

const Vec3& farthest(std::span<const Vec3> points, const Vec3& along) {
  const Vec3* best = &points[0];
  double most = along.dot(points[0]);
  for (const Vec3& p : points.subspan(1))
    if (const double here = along.dot(p); here > most) most = here, best = &p;
  return *best;
}

}  // namespace

Closest closest(std::span<const Vec3> a, std::span<const Vec3> b) {
  Simplex simplex;
  simplex[0] = {a[0] - b[0], b[0]};
  int count = 1;
  Closest out{.distance = 0, .on_b = b[0]};
  Vec3 v = simplex[0].w, on_b = b[0];
  double length2 = v.squaredNorm();
  for (int iteration = 0; iteration < 64; ++iteration) {
    const double length = std::sqrt(length2);
    if (length < 1e-12) return {.distance = 0, .normal = out.normal, .on_b = on_b};
    const Vec3 n = v / length;
    const Corner next{farthest(a, -n) - farthest(b, n), farthest(b, n)};
    const double separation = n.dot(next.w);
    if (separation > out.distance) out.distance = separation, out.normal = n;
    out.on_b = on_b;  // v only gets shorter, also where the separation along it was known before
    if (length - separation <= 1e-13 + 1e-12 * length) break;
    if (std::any_of(simplex.begin(), simplex.begin() + count, [&](const Corner& c) { return c.w == next.w; })) break;

    simplex[static_cast<std::size_t>(count++)] = next;
    Nearest nearest;
    if (count == 2)
      on_segment(nearest, simplex, 0, 1);
    else if (count == 3)
      on_triangle(nearest, simplex, 0, 1, 2);
    else if (!on_tetrahedron(nearest, simplex))
      return {.distance = 0, .normal = out.normal, .on_b = on_b};
    if (!(nearest.length2 < length2)) break;

    Simplex kept;
    v = on_b = Vec3::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(nearest.count); ++k) {
      kept[k] = simplex[static_cast<std::size_t>(nearest.corner[k])];
      v += nearest.weight[k] * kept[k].w;
      on_b += nearest.weight[k] * kept[k].b;
    }
    simplex = kept;
    count = nearest.count;
    length2 = nearest.length2;
  }
  return out;
}

}  // namespace zwang::collision
