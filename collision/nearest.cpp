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
  const auto visit = [&](std::uint32_t t, std::uint32_t end) {
    for (; t < end; ++t) {
      const Vec3 q = nearest_point(tree.triangle(t), p);
      const double square = (q - p).squaredNorm();
      if (!(square < least) || hidden_by_any([&](const Plane& plane) { return plane.hides(q); })) continue;
      least = square;
      best = {std::sqrt(square), q, t};
    }
  };
  const std::span<const TreeNode> nodes = tree.nodes();
  const auto bound = [&](std::size_t node) {
    const double square = nodes[node].distance2(p);
    const Slab* slab = square < least ? tree.slab(node) : nullptr;
    return slab ? std::max(square, slab->distance2(p)) : square;
  };
  const auto hidden_node = [&](std::size_t node) {
    const Slab* slab = hidden.empty() ? nullptr : tree.slab(node);
    return hidden_by_any([&](const Plane& plane) {
      return hides(plane, nodes[node]) || (slab && slab->highest(plane.normal) <= plane.offset + Plane::tolerance);
    });
  };
  struct Open {
    std::size_t node;
    double square;
  };
  std::array<Open, 96> open;  // farther ones wait
  std::size_t count = 0;
  open[count++] = {0, bound(0)};
  while (count > 0) {
    auto [i, square] = open[--count];
    while (square < least && !hidden_node(i)) {
      if (tree.leaf(i)) {
        visit(nodes[i].first, tree.range(i).second);
        break;
      }
      if (count == open.size()) {
        tree.walk([&](const TreeNode&, std::size_t node) { return bound(node) < least && !hidden_node(node); }, visit,
                  i);
        break;
      }
      Open near{i + 1, bound(i + 1)}, far{nodes[i + 1].skip, bound(nodes[i + 1].skip)};
      if (far.square < near.square) std::swap(near, far);
      if (far.square < least) open[count++] = far;
      i = near.node, square = near.square;
    }
  }
  return best;
}

}  // namespace zwang::collision
