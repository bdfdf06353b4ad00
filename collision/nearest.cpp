#include <zwang/collision/nearest.h>

#include <algorithm>
#include <cmath>

#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::collision {
namespace {

bool hides(const Plane& plane, const TreeNode& node) {
  double highest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = plane.normal[static_cast<Index>(k)];
    highest += n * static_cast<double>(n > 0 ? node.high[k] : node.low[k]);
  }
  return highest <= plane.offset + Plane::tolerance;
}

}  // namespace

std::optional<NearestPoint> nearest(const Tree& tree, const Vec3& p, double reach, std::span<const Plane> hidden) {
  const auto hidden_by_any = [&](const auto& test) { return std::any_of(hidden.begin(), hidden.end(), test); };
  std::optional<NearestPoint> best;
  double least = reach * reach;
  const auto enter = [&](const TreeNode& node, std::size_t) {
    return node.distance2(p) < least && !hidden_by_any([&](const Plane& plane) { return hides(plane, node); });
  };
  tree.walk(enter, [&](std::uint32_t t, std::uint32_t end) {
    for (; t < end; ++t) {
      const Vec3 q = nearest_point(tree.triangle(t), p);
      const double square = (q - p).squaredNorm();
      if (!(square < least) || hidden_by_any([&](const Plane& plane) { return plane.hides(q); })) continue;
      least = square;
      best = {std::sqrt(square), q, t};
    }
  });
  return best;
}

}  // namespace zwang::collision
