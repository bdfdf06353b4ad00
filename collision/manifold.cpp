#include "collision/manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang::collision {

void Manifold::keep(std::uint32_t touch) {
  if (is_kept_[touch]) return;
  is_kept_[touch] = 1;
  kept_.push_back(touch);
}

void Manifold::reduce(std::span<const Touch> touches) {
  kept_.clear();
  is_kept_.assign(touches.size(), 0);
  for (std::uint32_t first = 0, end = 0; first < touches.size(); first = end) {
    while (end < touches.size() && touches[end].a == touches[first].a) ++end;
    reduce_one(touches, first, end);
  }
  std::sort(kept_.begin(), kept_.end());
}

// Greedy, by rising gap: a touch joins the first cluster whose first normal it is near to, or opens one. Within a
// cluster, seen along its normal: the closest, the farthest from it, the farthest from the line through both, and the
// farthest on the other side of that line.
void Manifold::reduce_one(std::span<const Touch> touches, std::uint32_t first, std::uint32_t end) {
  const double near = std::cos(options_.cone);
  order_.resize(end - first);
  for (std::uint32_t i = first; i < end; ++i) order_[i - first] = i;
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
    return touches[i].gap != touches[j].gap ? touches[i].gap < touches[j].gap : i < j;
  });
  clusters_.clear();
  cluster_of_.assign(order_.size(), -1);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const Touch& t = touches[order_[k]];
    auto home = std::find_if(clusters_.begin(), clusters_.end(),
                             [&](const Cluster& c) { return c.b == t.b && c.normal.dot(t.normal) >= near; });
    if (home == clusters_.end()) {
      if (static_cast<int>(clusters_.size()) == options_.clusters) continue;
      home = clusters_.insert(home, {t.b, t.normal, k, 0});
    }
    cluster_of_[k] = static_cast<int>(home - clusters_.begin());
    ++home->count;
  }
  for (int c = 0; c < static_cast<int>(clusters_.size()); ++c) {
    const Cluster& cluster = clusters_[static_cast<std::size_t>(c)];
    const auto point = [&](std::size_t k) -> const Vec3& { return touches[order_[k]].point_b; };
    // The member for which `score` is largest, when it is larger than 0.
    const auto best = [&](auto score) {
      std::size_t winner = order_.size();
      double most = 1e-12;
      for (std::size_t k = cluster.first; k < order_.size(); ++k)
        if (cluster_of_[k] == c)
          if (const double s = score(point(k)); s > most) most = s, winner = k;
      return winner;
    };
    int left = options_.per_cluster;
    const auto take = [&](std::size_t k) {
      if (left <= 0 || k == order_.size()) return false;
      keep(order_[k]);
      --left;
      return true;
    };
    take(cluster.first);
    const Vec3 p = point(cluster.first);
    const std::size_t far = best([&](const Vec3& q) { return (q - p).squaredNorm(); });
    if (!take(far)) continue;
    const Vec3 across = cluster.normal.cross(point(far) - p);
    take(best([&](const Vec3& q) { return across.dot(q - p); }));
    take(best([&](const Vec3& q) { return -across.dot(q - p); }));
  }
}

int Manifold::complete(std::span<const Touch> touches, const World& world, std::span<const Vec<double, 6>> twist,
                       double target, double tolerance) {
  const auto moved = [&](int collider, const Vec3& point) {
    const Vec<double, 6>& v = twist[static_cast<std::size_t>(collider)];
    return Vec3(v.head<3>() + v.tail<3>().cross(point - world.pose(collider).position));
  };
  int added = 0;
  for (std::uint32_t first = 0, end = 0; first < touches.size(); first = end) {
    double worst = -tolerance;
    std::uint32_t winner = 0;
    bool any = false;
    for (; end < touches.size() && touches[end].a == touches[first].a && touches[end].b == touches[first].b; ++end) {
      const Touch& t = touches[end];
      if (is_kept_[end]) continue;
      const double over = t.gap - target + t.normal.dot(moved(t.a, t.point_a) - moved(t.b, t.point_a));
      if (over < worst) worst = over, winner = end, any = true;
    }
    if (!any) continue;
    keep(winner);
    ++added;
  }
  return added;
}

}  // namespace zwang::collision
