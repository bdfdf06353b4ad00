#include <zwang/collision/narrow_phase/patch.h>

#include <zwang/collision/narrow_phase/approach.h>

namespace zwang::collision {
namespace {

// Triangles of slivers up to which the corners say how high a plane over them lies: boxes of more are as good, or of no
// use to begin with.
constexpr std::uint32_t exact_size = 256;

// The point that is highest along `up`. (Two or four maxima in parallel are slower: memory is the limit.)
struct Highest {
  double height = -std::numeric_limits<double>::infinity();
  std::size_t at = 0;

  Highest(const Vec3& up, std::span<const Vec3> points) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const double here = up.dot(points[i]); here > height) height = here, at = i;
  }
};

// Of the core above all that is no higher than `height` along the normal, in B's axes and, `local`, in A's.
double separation(const Shape& shape, const Pose<double>& place, const Vec3& local, const Vec3& normal, double height) {
  return -local.cwiseAbs().dot(shape.half()) - (height - normal.dot(place.position));
}

// Of a subtree the triangle nearest to the core, as far as boxes tell.
std::uint32_t nearest_triangle(const Shape& shape, const Pose<double>& place, const Tree& tree, std::size_t node) {
  Vec3 p = place.position;
  while (!tree.leaf(node)) {
    const std::size_t left = node + 1, right = tree.nodes()[left].skip;
    const Vec3 on_left = tree.nearest(left, p), on_right = tree.nearest(right, p);
    const bool nearer = (on_left - p).squaredNorm() <= (on_right - p).squaredNorm();
    node = nearer ? left : right;
    p = place * shape.nearest(place.rotation.transpose() * ((nearer ? on_left : on_right) - place.position));
  }
  const auto [begin, end] = tree.range(node);
  return std::ranges::min(std::views::iota(begin, end), {},
                          [&](std::uint32_t t) { return (nearest_point(tree.triangle(t), p) - p).squaredNorm(); });
}

}  // namespace

bool patch_plane(const Region& region, const Region::LocalBox& box, std::span<const Vec3> points, double stop,
                 Closest& out) {
  const Shape& shape = region.shape;
  const Vec3 core = shape.nearest(box.at), apart = core - box.at;
  // A vertex that is off to the side by e is e^2 / (2 length) farther away than its plane, unless it is under a flat
  // side. (The first test is a bound that needs no square root.)
  const bool beside = ((apart.array() != 0).count() > 1);
  if (beside && stop <= shape.radius() && box.half.squaredNorm() > 0.8 * apart.squaredNorm()) return false;
  const double length = apart.norm();
  if (length <= shape.radius()) return false;
  const double slack = (stop + length - shape.radius()) / 10;
  const Vec3 n = apart / length, up = region.a_in_b.rotation * n;
  if (beside && box.half.squaredNorm() > 8 * length * slack) return false;
  const Highest highest(up, points);
  out.on_b = points[highest.at];
  out.normal = up;
  out.distance = separation(shape, region.a_in_b, n, up, highest.height);
  const Vec3 local = region.a_in_b.rotation.transpose() * (out.on_b - region.a_in_b.position);
  const double gap = out.distance - shape.radius();
  return gap > stop / 2 && (local - shape.nearest(local)).norm() - out.distance <= (stop + gap) / 10;
}

Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Vec3> points, const Vec3& near) {
  const Vec3 local = place.rotation.transpose() * (near - place.position);
  const Vec3 n = (shape.nearest(local) - local).normalized();
  Closest out{.normal = place.rotation * n};
  const Highest highest(out.normal, points);
  out.on_b = points[highest.at];
  out.distance = separation(shape, place, n, out.normal, highest.height);
  return out;
}

PlaneOver plane_over(const Shape& shape, const Pose<double>& place, const Tree& tree, std::size_t node, double reach) {
  const auto [begin, end] = tree.range(node);
  const Triangle near = tree.triangle(nearest_triangle(shape, place, tree, node));
  PlaneOver out{closest(shape, place, {.triangle = &near}, reach)};
  out.most = out.distance;
  const Vec3& n = out.normal;
  const double height = end - begin > exact_size ? tree.height(node, n) : Highest(n, tree.points(begin, end)).height;
  out.on_b += (height - n.dot(out.on_b)) * n;
  out.distance = separation(shape, place, place.rotation.transpose() * n, n, height);
  return out;
}

}  // namespace zwang::collision
