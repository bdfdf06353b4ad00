#include <algorithm>

#include <zwang/collision/patch.h>
#include <zwang/collision/world.h>

// What lies near what: the part of World that walks the trees.

namespace zwang::collision {

// Shape against everything near it. With moves, also what its sweep comes near to.
void World::collect(double activation, Found& found) {
  found.pairs.clear();
  found.candidates.clear();
  double others = 0;
  for (int c = 0; c < size(); ++c) others = std::max(others, travel(c));
  for (int a = 0; a < size(); ++a) {
    if (!shape(a)) continue;
    Vec3 low, high;
    box_of(at(a), low, high);
    const Vec3 margin = Vec3::Constant(activation + 2 * margins_.stop + travel(a) + others);
    broad_phase_.query(low - margin, high + margin, met_);
    for (const int b : met_)
      if (looked_at(a, b)) gather(a, b, activation, found);
  }
}

void World::gather(int a, int b, double activation, Found& found) const {
  const Shape& shape = *this->shape(a);
  const Relative motion(course(a), course(b), shape.reach());
  const std::size_t first = found.candidates.size();
  const bool moves = motion.travel() > 0;
  const double reach = moves ? std::max(activation, motion.travel() + 2 * margins_.stop) : activation;
  if (const Tree* tree = mesh(b)) {
    // A curved path leaves the chord between its ends by at most bend / 8.
    const double curve = motion.along_path() ? motion.travel() : motion.bend() / 8;
    Region region(shape, motion.start().place,
                  shape.radius() + (moves ? std::max(activation, 2 * margins_.stop + curve) : activation));
    if (moves && !motion.along_path()) region.include(motion.at(1).place, margins_.stop + curve + shape.radius());
    walk(*tree, region, reach, found.candidates);
  } else {
    const Shape& other = *this->shape(b);
    const Closest c = closest(shape, motion.start().place, {.shape = &other}, 0);
    if (c.distance - shape.radius() - other.radius() <= reach) found.candidates.push_back({0, 1, c});
  }
  if (found.candidates.size() > first) found.pairs.push_back({a, b, first, found.candidates.size()});
}

// What of a mesh lies in the region and within `reach` of its shape: patches where one plane says enough, else
// triangles.
void World::walk(const Tree& tree, const Region& region, double reach, std::vector<Candidate>& candidates) const {
  const Shape& shape = region.shape;
  const Pose<double>& place = region.a_in_b;
  const std::span<const TreeNode> nodes = tree.nodes();
  Region::Seen seen;
  for (std::size_t i = 0; i < nodes.size();) {
    const TreeNode& node = nodes[i];
    if (region.misses(node, seen)) {
      i = node.skip;
      continue;
    }
    const auto [begin, end] = tree.range(i);
    if (shape.core() != Core::hull && end - begin <= patch_size) {
      Closest c;
      if (stand_in(region, seen, tree.points(begin, end), margins_.stop, c)) {
        if (c.distance - shape.radius() <= reach) candidates.push_back({begin, end, c});
        i = node.skip;
        continue;
      }
    }
    if (!tree.leaf(i++)) continue;
    const std::span<const Vec3> points = tree.points(begin, end);
    std::array<Vec3, 3 * Tree::leaf_size> local;
    for (std::size_t k = 0; k < points.size(); ++k)
      local[k] = place.rotation.transpose() * (points[k] - place.position);
    const std::uint32_t base = tree.corners()[begin][0];
    for (std::uint32_t t = begin; t < end; ++t) {
      const auto& corner = tree.corners()[t];
      const Triangle triangle{local[corner[0] - base], local[corner[1] - base], local[corner[2] - base]};
      if (region.misses(triangle)) continue;
      Closest c = closest(shape, triangle, shape.radius() + reach);
      if (c.distance - shape.radius() > reach) continue;
      c.normal = place.rotation * c.normal;
      c.on_b = place * c.on_b;
      candidates.push_back({t, t + 1, c});
    }
  }
}

std::span<const Touch> World::touches(double activation) {
  std::fill(move_of_.begin(), move_of_.end(), nullptr);
  if (near_reach_ != activation) collect(activation, near_);
  near_reach_ = activation;
  touches_.clear();
  for (const Pair& pair : near_.pairs) {
    const Pose<double>& of_b = pose(pair.b);
    const Tree* tree = mesh(pair.b);
    const double radius = shape(pair.a)->radius(), radius_b = tree ? 0 : shape(pair.b)->radius();
    const auto add = [&](const Closest& c, std::uint32_t feature) {
      const Vec3 n = of_b.rotation * c.normal, on_b = of_b * c.on_b + radius_b * n;
      const double gap = c.distance - radius - radius_b;
      touches_.push_back({pair.a, pair.b, feature, gap, n, on_b + gap * n, on_b});
    };
    for (std::size_t i = pair.first; i < pair.end; ++i)
      add(near_.candidates[i].closest, tree ? tree->origin(near_.candidates[i].first) : 0);
    if (tree) continue;
    const Relative now(course(pair.a), course(pair.b), 0);
    facing(*shape(pair.a), now.start().place, *shape(pair.b), near_.candidates[pair.first].closest, activation,
           facing_);
    for (int k = 0; k < facing_.count; ++k)
      add(facing_.at[static_cast<std::size_t>(k)], static_cast<std::uint32_t>(k + 1));
  }
  return touches_;
}

}  // namespace zwang::collision
