#include <zwang/collision/narrow_phase/closest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
  for (int k = 0; k < candidate.count; ++k) v += candidate.weight[at(k)] * s[at(candidate.corner[at(k)])].w;
  if (const double length2 = v.squaredNorm(); length2 < best.length2) {
    best = candidate;
    best.length2 = length2;
  }
}

void on_segment(Nearest& best, const Simplex& s, int i, int j) {
  const Vec3& p = s[at(i)].w;
  const Vec3 d = s[at(j)].w - p;
  const double length2 = d.squaredNorm(), along = -p.dot(d);
  if (!(along > 0)) return keep_nearer(best, s, {1, {i}, {1}, 0});
  if (along >= length2) return keep_nearer(best, s, {1, {j}, {1}, 0});
  const double t = along / length2;
  keep_nearer(best, s, {2, {i, j}, {1 - t, t}, 0});
}

// Inside, or on one of the three edges.
void on_triangle(Nearest& best, const Simplex& s, int i, int j, int k) {
  const Vec3 &a = s[at(i)].w, &b = s[at(j)].w, &c = s[at(k)].w;
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

    simplex[at(count++)] = next;
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
    for (std::size_t k = 0; k < at(nearest.count); ++k) {
      kept[k] = simplex[at(nearest.corner[k])];
      v += nearest.weight[k] * kept[k].w;
      on_b += nearest.weight[k] * kept[k].b;
    }
    simplex = kept;
    count = nearest.count;
    length2 = nearest.length2;
  }
  return out;
}

// By its Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
Vec3 nearest_point(const Triangle& t, const Vec3& p) {
  const auto& [a, b, c] = t.corner;
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

namespace {

// The separation of the two along n, a lower bound of their distance for any unit vector n; equal to it for the
// direction between the nearest points. Every answer below is checked by it.
double separation(std::span<const Vec3> core, const Triangle& t, const Vec3& n) {
  double low = n.dot(core[0]);
  for (const Vec3& p : core.subspan(1)) low = std::min(low, n.dot(p));
  return low - std::max({n.dot(t.corner[0]), n.dot(t.corner[1]), n.dot(t.corner[2])});
}

struct Pair {
  Vec3 a, b;
  double distance2 = std::numeric_limits<double>::infinity();
  void offer(const Vec3& on_a, const Vec3& on_b) {
    if (const double d2 = (on_a - on_b).squaredNorm(); d2 < distance2) *this = {on_a, on_b, d2};
  }
};

// The nearest points of two segments (same book, 5.1.9).
void segment_segment(Pair& best, const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 u = q - p, v = b - a, w = p - a;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double denominator = uu * vv - uv * uv;
  double s = denominator > 0 ? std::clamp((uv * vw - uw * vv) / denominator, 0.0, 1.0) : 0;
  double t = vv > 0 ? (uv * s + vw) / vv : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0;
  }
  best.offer(p + s * u, a + t * v);
}

bool over_inside(const Triangle& t, const Vec3& n, const Vec3& x) {
  const auto& [a, b, c] = t.corner;
  return (b - a).cross(x - a).dot(n) >= 0 && (c - b).cross(x - b).dot(n) >= 0 && (a - c).cross(x - c).dot(n) >= 0;
}

// Where the projection of the end nearer to the triangle's plane is inside the triangle, that is the nearest pair; else
// ends and edges are compared.
Pair segment_triangle(const Vec3& p, const Vec3& q, const Triangle& t) {
  const auto& [a, b, c] = t.corner;
  const Vec3 ab = b - a, ac = c - a, n = ab.cross(ac);
  const double over_p = n.dot(p - a), over_q = n.dot(q - a);
  const bool crosses = (over_p > 0) != (over_q > 0), p_first = std::abs(over_p) <= std::abs(over_q);
  Pair best;
  if (crosses) {  // within the triangle?
    const Vec3 x = p + over_p / (over_p - over_q) * (q - p);
    if (over_inside(t, n, x)) {
      best.offer(x, x);
      return best;
    }
  }
  // Is the foot of an end inside? By its barycentric coordinates, times |n|^2.
  const double bb = ab.squaredNorm(), bc = ab.dot(ac), cc = ac.squaredNorm(), all = bb * cc - bc * bc;
  const Vec3 upright = n / n.squaredNorm();
  const auto offer_foot = [&](const Vec3& end, double over) {
    const double to_b = ab.dot(end - a), to_c = ac.dot(end - a);
    const double of_b = cc * to_b - bc * to_c, of_c = bb * to_c - bc * to_b;
    if (!(all > 0 && of_b >= 0 && of_c >= 0 && of_b + of_c <= all)) return false;
    best.offer(end, end - over * upright);
    return true;
  };
  if (offer_foot(p_first ? p : q, p_first ? over_p : over_q) && !crosses) return best;
  offer_foot(p_first ? q : p, p_first ? over_q : over_p);
  segment_segment(best, p, q, a, b);
  segment_segment(best, p, q, b, c);
  segment_segment(best, p, q, c, a);
  return best;
}

// A face of the box against a corner of the triangle, or the triangle's face against a corner of the box: in both cases
// a separating plane touches the two sets at points opposite each other. Covers nearly all pairs of a box on a mesh.
bool by_face(const Shape& box, const Triangle& t, double reach, Closest& out) {
  const Vec3& h = box.half();
  const auto& [a, b, c] = t.corner;
  const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  double most = 0;
  int axis = -1;
  bool above = false;
  for (int k = 0; k < 3; ++k) {
    if (low[k] - h[k] > most) most = low[k] - h[k], axis = k, above = true;
    if (-h[k] - high[k] > most) most = -h[k] - high[k], axis = k, above = false;
  }
  if (axis >= 0) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Vec3 n = (above ? -1.0 : 1.0) * Vec3::Unit(axis);  // from the triangle to the box
    for (const Vec3& p : t.corner)
      if (p[axis] == (above ? low[axis] : high[axis]) && std::abs(p[j]) <= h[j] && std::abs(p[k]) <= h[k]) {
        out = {most, n, p};
        return true;
      }
    if (most >= reach) {
      out = {most, n, a};
      return true;
    }
  }
  Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  if (!(length > 0)) return false;
  n /= length;
  if (n.dot(a) > 0) n = -n;  // toward the box's centre
  const Vec3 corner(n.x() > 0 ? -h.x() : h.x(), n.y() > 0 ? -h.y() : h.y(), n.z() > 0 ? -h.z() : h.z());
  const double over = n.dot(corner - a);
  if (over <= 0) return false;
  const Vec3 x = corner - over * n;
  if (!over_inside(t, (b - a).cross(c - a), x) && over < reach) return false;
  out = {separation(box.corners(), t, n), n, x};
  return out.distance > 0;
}

}  // namespace

Closest closest(const Shape& shape, const Triangle& triangle, double reach) {
  const std::span<const Vec3> core = shape.corners();
  if (core.size() <= 2) {
    Pair pair;
    if (core.size() == 1)
      pair.offer(core[0], nearest_point(triangle, core[0]));
    else
      pair = segment_triangle(core[0], core[1], triangle);
    const double distance = std::sqrt(pair.distance2);
    if (distance < 1e-12) return {.distance = 0, .on_b = pair.b};
    const Vec3 n = (pair.a - pair.b) / distance;
    const double proven = separation(core, triangle, n);
    if (proven >= distance - 1e-12 - 1e-9 * distance) return {proven, n, pair.b};
  } else if (Closest out; shape.core() == Core::box && by_face(shape, triangle, reach, out)) {
    return out;
  }
  return closest(core, triangle.corner);  // slivers that cancel, edges of boxes, hulls
}

}  // namespace zwang::collision
