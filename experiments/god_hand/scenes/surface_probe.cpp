#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/experiments/god_hand/scenes/scene_objects.h>

namespace zwang::god {
namespace {

// How far along the ray from p in direction d the mesh is first met (Moeller & Trumbore 1997, both sides).
double first_hit(const collision::Tree& tree, const Vec3& p, const Vec3& d) {
  double nearest = infinity;
  const auto enter = [&](const collision::TreeNode& node, std::size_t) {
    double in = 0, out = nearest;
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      if (d[k] == 0) {
        if (p[k] < node.low[a] || p[k] > node.high[a]) out = -1;
        continue;
      }
      const double s = (node.low[a] - p[k]) / d[k], t = (node.high[a] - p[k]) / d[k];
      in = std::max(in, std::min(s, t)), out = std::min(out, std::max(s, t));
    }
    return in <= out;
  };
  tree.walk(enter, [&](std::uint32_t first, std::uint32_t end) {
    for (const collision::Triangle& t : tree.triangles(first, end)) {
      const auto& [a, b, c] = t.corner;
      const Vec3 e = b - a, f = c - a, h = d.cross(f), s = p - a, q = s.cross(e);
      const double det = e.dot(h), u = s.dot(h) / det, v = d.dot(q) / det, at = f.dot(q) / det;
      if (det != 0 && u >= 0 && v >= 0 && u + v <= 1 && at >= 0) nearest = std::min(nearest, at);
    }
  });
  return nearest;
}

struct Seen {
  double height = -infinity;  // m
  int object = -1;
};

Seen highest_at(const Surroundings& surroundings, double x, double y) {
  constexpr double above = 100;  // m
  Seen seen;
  for (std::size_t k = 0; k < surroundings.objects.size(); ++k) {
    const Object& object = surroundings.objects[k];
    if (!object.mesh) continue;
    const Mat3 inverse = object.pose.rotation.transpose();
    const double way =
        first_hit(*object.mesh, inverse * (Vec3(x, y, above) - object.pose.position), inverse * Vec3(0, 0, -1));
    if (above - way > seen.height) seen = {above - way, static_cast<int>(k)};
  }
  return seen;
}

}  // namespace

Vec3 surface_at(const Surroundings& surroundings, double x, double y) {
  return {x, y, highest_at(surroundings, x, y).height};
}

// Heights over a grid; then for each point of it what a hand's width around lies less than 20 mm below it. Every object
// there counts with the root of its share: two half covered places are better than one full one. Places from which
// something sticks out by more than 20 mm are left out.
Vec3 busiest_place(const Surroundings& surroundings) {
  Eigen::AlignedBox3d box;
  for (const Object& object : surroundings.objects) {
    if (!object.mesh) continue;
    const Vec3 middle = object.pose * object.mesh->box().center();
    const Vec3 half = object.pose.rotation.cwiseAbs() * object.mesh->box().sizes() / 2;
    box.extend({middle - half, middle + half});
  }
  const Vec3 low = box.min(), high = box.max();
  const double step = std::max(0.01, std::max(high.x() - low.x(), high.y() - low.y()) / 100);
  const int nx = static_cast<int>((high.x() - low.x()) / step) + 1,
            ny = static_cast<int>((high.y() - low.y()) / step) + 1;
  std::vector<Seen> seen;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      seen.push_back(highest_at(surroundings, low.x() + (i + 0.5) * step, low.y() + (j + 0.5) * step));
  const auto at = [&](int i, int j) { return seen[static_cast<std::size_t>(j * nx + i)]; };
  double best = -1;
  Vec3 place((low.x() + high.x()) / 2, (low.y() + high.y()) / 2, high.z());
  const int reach = static_cast<int>(0.05 / step);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (at(i, j).object < 0) continue;
      std::map<int, int> count;
      double highest = at(i, j).height;
      for (int v = std::max(0, j - reach); v <= std::min(ny - 1, j + reach); ++v)
        for (int u = std::max(0, i - reach); u <= std::min(nx - 1, i + reach); ++u) {
          highest = std::max(highest, at(u, v).height);
          if (std::abs(at(u, v).height - at(i, j).height) < 0.02) ++count[at(u, v).object];
        }
      if (highest > at(i, j).height + 0.02) continue;
      double score = 0;
      for (const auto& [object, n] : count) score += std::sqrt(n);
      const Vec3 here(low.x() + (i + 0.5) * step, low.y() + (j + 0.5) * step, at(i, j).height);
      // Of equal ones the one nearer to the middle.
      score -= 1e-3 * ((here - (low + high) / 2).head<2>().norm()) / step;
      if (score > best) best = score, place = here;
    }
  return place;
}

}  // namespace zwang::god
