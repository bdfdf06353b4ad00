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

// A first walk down the nearer children gives a bound; then all that is nearer is looked at. Of triangles that are
// equally near the first one counts.
std::optional<NearestPoint> nearest(const Tree& tree, const Vec3& p, double reach, std::span<const Plane> hidden) {
  const auto hidden_by_any = [&](const auto& test) { return std::any_of(hidden.begin(), hidden.end(), test); };
  const std::span<const TreeNode> nodes = tree.nodes();
  NearestPoint best{.triangle = tree.size()};
  double least = reach * reach;
  const auto nearer = [&](double square, std::uint32_t triangle) {
    return square < least || (square == least && triangle < best.triangle && best.triangle < tree.size());
  };
  const auto visit = [&](std::uint32_t t, std::uint32_t end) {
    for (; t < end; ++t) {
      const Vec3 q = nearest_point(tree.triangle(t), p);
      const double square = (q - p).squaredNorm();
      if (!nearer(square, t) || hidden_by_any([&](const Plane& plane) { return plane.hides(q); })) continue;
      least = square;
      best = {0, q, t};
    }
  };
  const auto bound = [&](std::size_t node) {
    const double square = nodes[node].distance2(p);
    const Slab* slab = square < least ? tree.slab(node) : nullptr;
    return slab ? std::max(square, slab->distance2(p)) : square;
  };
  std::size_t top = 0;
  while (!tree.leaf(top)) top = bound(top + 1) <= bound(nodes[top + 1].skip) ? top + 1 : nodes[top + 1].skip;
  visit(nodes[top].first, tree.range(top).second);
  const std::size_t seen = top;
  tree.walk(
      [&](const TreeNode& node, std::size_t number) {
        if (number == seen || !nearer(node.distance2(p), node.first)) return false;
        if (const Slab* slab = tree.slab(number); slab && !nearer(slab->distance2(p), node.first)) return false;
        return !hidden_by_any([&](const Plane& plane) { return hides(plane, node); });
      },
      visit);
  if (best.triangle == tree.size()) return {};
  best.distance = std::sqrt(least);
  return best;
}

}  // namespace zwang::collision
