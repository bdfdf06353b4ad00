#include <zwang/collision/manifold.h>

#include <algorithm>
#include <cmath>

namespace zwang::collision {

// m, and relative: touches that differ by less are equal, and the first one wins. On flat faces many touches are equal
// up to rounding, and which of them is kept must not depend on rounding, or the motion would.
static constexpr double tie = 1e-9;

void Manifold::keep(std::uint32_t touch) {
  if (is_kept_[touch]) return;
  is_kept_[touch] = 1;
  kept_.push_back(touch);
}

void Manifold::reduce(std::span<const Touch> touches, bool all) {
  kept_.clear();
  is_kept_.assign(touches.size(), 0);
  for (std::uint32_t i = 0; all && i < touches.size(); ++i) keep(i);
  if (all) return;
  for (std::uint32_t first = 0, end = 0; first < touches.size(); first = end) {
    while (end < touches.size() && touches[end].a == touches[first].a) ++end;
    reduce_one(touches, first, end);
  }
  std::sort(kept_.begin(), kept_.end());
}

// Is the obstacle's point of `t` behind the plane of `top`, and the body's point in front of it? Then a body that stays
// in front of that plane cannot reach the point. This holds for all triangles around the nearest one of a flat face,
// whose nearest points are on their edges and whose normals are tilted outward.
static bool implied(const Touch& t, const Touch& top) {
  constexpr double rounding = 1e-9;  // m
  return t.b == top.b && top.normal.dot(t.point_b - top.point_b) <= rounding &&
         top.normal.dot(t.point_a - top.point_b) >= 0;
}

// The closest touch outside all clusters starts the next one, with all touches on the same partner whose normals are
// near its own: one pass per cluster, no sorting. Kept of a cluster: the closest touch, the farthest from it, the
// farthest from the line through both, and the farthest on the other side of that line.
void Manifold::reduce_one(std::span<const Touch> touches, std::uint32_t first, std::uint32_t end) {
  const double near = std::cos(cone);
  left_.resize(end - first);
  for (std::uint32_t i = first; i < end; ++i) left_[i - first] = i;
  for (int c = 0; c < clusters && !left_.empty(); ++c) {
    std::uint32_t closest = left_.front();
    for (const std::uint32_t i : left_)
      if (touches[i].gap < touches[closest].gap - tie) closest = i;
    const Touch& top = touches[closest];
    members_.clear();
    std::size_t others = 0;
    for (const std::uint32_t i : left_)
      if (touches[i].b == top.b && top.normal.dot(touches[i].normal) >= near)
        members_.push_back(i);
      else if (!implied(touches[i], top))
        left_[others++] = i;
    left_.resize(others);
    keep_corners(touches, closest);
  }
}

void Manifold::keep_corners(std::span<const Touch> touches, std::uint32_t closest) {
  int left = per_cluster_;
  // The member for which `score` is largest, when it is larger than 0.
  const auto take = [&](auto score) {
    if (left == 0) return closest;
    std::uint32_t winner = closest;
    double most = 1e-12;
    for (const std::uint32_t i : members_)
      if (const double s = score(touches[i].point_b); s > most) most = s * (1 + tie), winner = i;
    if (winner != closest) keep(winner), --left;
    return winner;
  };
  keep(closest), --left;
  const Vec3 p = touches[closest].point_b;
  const std::uint32_t far = take([&](const Vec3& q) { return (q - p).squaredNorm(); });
  if (far == closest) return;
  const Vec3 across = touches[closest].normal.cross(touches[far].point_b - p);
  take([&](const Vec3& q) { return across.dot(q - p); });
  take([&](const Vec3& q) { return -across.dot(q - p); });
}

int Manifold::complete(std::span<const Touch> touches, const World& world, std::span<const Vec<double, 6>> twist,
                       double target, double tolerance, bool push) {
  const auto moved = [&](int collider, const Vec3& point) {
    const Vec<double, 6>& v = twist[at(collider)];
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
      const double over = t.gap - (push ? target : std::min(target, t.gap)) +
                          t.normal.dot(moved(t.a, t.point_a) - moved(t.b, t.point_a));
      if (over < worst) worst = over, winner = end, any = true;
    }
    if (!any) continue;
    keep(winner);
    ++added;
  }
  return added;
}

}  // namespace zwang::collision
