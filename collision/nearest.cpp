#include <zwang/collision/nearest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::collision {
namespace {

bool hides(const Plane& plane, const TreeNode& node) {
  return node.height(plane.normal) <= plane.offset + Plane::tolerance;
}

}  // namespace

// Walks down the nearer children give a bound; then all that is nearer is looked at. Of triangles that are equally near
// the first one counts. One large triangle among slivers makes their box near to everything, and what is in it may be
// far: so of slivers the nearest half that was passed by is where the next walk down starts.
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
  std::pair<double, std::size_t> other{0, 0};
  std::size_t top = 0;
  const int descents = tree.of_slivers() ? 4 : 1;
  for (int k = 0; k < descents && other.first < least; ++k) {
    top = std::exchange(other, {least, 0}).second;
    while (!tree.leaf(top)) {
      const std::size_t left = top + 1, right = nodes[left].skip;
      const auto [near, far] = std::minmax({std::pair(bound(left), left), std::pair(bound(right), right)});
      other = std::min(other, far);
      top = near.second;
    }
    visit(nodes[top].first, tree.range(top).second);
  }
  tree.walk(
      [&](const TreeNode& node, std::size_t number) {
        if (number == top || !nearer(node.distance2(p), node.first)) return false;
        if (const Slab* slab = tree.slab(number); slab && !nearer(slab->distance2(p), node.first)) return false;
        return !hidden_by_any([&](const Plane& plane) { return hides(plane, node); });
      },
      visit);
  if (best.triangle == tree.size()) return {};
  best.distance = std::sqrt(least);
  return best;
}

}  // namespace zwang::collision
