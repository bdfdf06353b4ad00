#include "collision/world.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace zwang::collision {
namespace {

// Which boxes and triangles of a mesh (B) may lie within a distance of a convex core or of its sweep: a box about them
// in B's axes and one in the axes of A. The second is what counts for a long finger that lies askew.
struct Region {
  Pose<double> a_in_b;
  Vec3 low, high;              // B's axes
  Vec3 local_low, local_high;  // A's axes

  const Shape& shape;

  Region(const Shape& a, const Pose<double>& at, double margin) : a_in_b(at), shape(a) {
    local_low = low = Vec3::Constant(std::numeric_limits<double>::infinity());
    local_high = high = -low;
    include(at, margin);
  }
  void include(const Pose<double>& at, double margin) {
    for (const Vec3& corner : shape.corners()) {
      const Vec3 p = at * corner, q = a_in_b.rotation.transpose() * (p - a_in_b.position);
      low = low.cwiseMin(p - Vec3::Constant(margin));
      high = high.cwiseMax(p + Vec3::Constant(margin));
      local_low = local_low.cwiseMin(q - Vec3::Constant(margin));
      local_high = local_high.cwiseMax(q + Vec3::Constant(margin));
    }
  }

  // A node's box in the axes of A: its middle and half widths.
  struct Seen {
    Vec3 at, half;
  };
  bool misses(const TreeNode& node, Seen& seen) const {
    Vec3 middle, half;
    for (int k = 0; k < 3; ++k) {
      const double l = node.low[static_cast<std::size_t>(k)], h = node.high[static_cast<std::size_t>(k)];
      if (l > high[k] || h < low[k]) return true;
      middle[k] = (l + h) / 2 - a_in_b.position[k];
      half[k] = (h - l) / 2;
    }
    for (int k = 0; k < 3; ++k) {
      const auto axis = a_in_b.rotation.col(k);
      seen.at[k] = axis.dot(middle), seen.half[k] = axis.cwiseAbs().dot(half);
      if (seen.at[k] - seen.half[k] > local_high[k] || seen.at[k] + seen.half[k] < local_low[k]) return true;
    }
    return false;
  }
  bool misses(const Triangle& local) const {
    const auto& [a, b, c] = local.corner;
    for (int k = 0; k < 3; ++k)
      if (std::min({a[k], b[k], c[k]}) > local_high[k] || std::max({a[k], b[k], c[k]}) < local_low[k]) return true;
    return false;
  }
};

constexpr std::uint32_t patch_size = 64;  // triangles

// One point for all triangles of a small subtree: the vertex that lies highest along n, the direction from the
// subtree's middle to the core. The plane through it keeps all of them from the core: `distance` is a lower bound for
// each, and the true distance of the vertex hardly more (a tenth of the stop distance and of the gap), or there is no
// answer. A palm or a finger on a fine mesh has tens of thousands of triangles within reach, which say the same thing.
bool stand_in(const Shape& shape, const Region& region, const Region::Seen& seen, std::span<const Triangle> triangles,
              std::uint32_t first, double stop, Closest& out, std::uint32_t& winner) {
  const Vec3 core = shape.nearest(seen.at), apart = core - seen.at;
  const double length = apart.norm();
  if (length <= shape.radius()) return false;
  const double slack = (stop + length - shape.radius()) / 10;
  const Vec3 n = apart / length, up = region.a_in_b.rotation * n;
  // Off to the side by e, a vertex is e^2 / (2 length) farther than its plane; not under a flat side.
  const bool beside = ((apart.array() != 0).count() > 1);
  if (beside && seen.half.squaredNorm() > 8 * length * slack) return false;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const Vec3& p : triangles[t].corner)
      if (const double here = up.dot(p); here > highest) highest = here, out.on_b = p, winner = first + t;
  out.normal = up;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest - up.dot(region.a_in_b.position));
  const Vec3 local = region.a_in_b.rotation.transpose() * (out.on_b - region.a_in_b.position);
  const double gap = out.distance - shape.radius();
  return gap > stop / 2 && (local - shape.nearest(local)).norm() - out.distance <= (stop + gap) / 10;
}

// The plane across the direction from `near`, a point of the triangles, to the core, moved out to the highest of their
// corners: a lower bound of the distance. B's axes.
Closest plane_between(const Shape& shape, const Pose<double>& place, std::span<const Triangle> triangles,
                      const Vec3& near) {
  const Vec3 local = place.rotation.transpose() * (near - place.position);
  const Vec3 n = (shape.nearest(local) - local).normalized();
  Closest out{.normal = place.rotation * n};
  double highest = -std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles)
    for (const Vec3& p : t.corner)
      if (const double here = out.normal.dot(p); here > highest) highest = here, out.on_b = p;
  out.distance = -n.cwiseAbs().dot(shape.half()) - (highest - out.normal.dot(place.position));
  return out;
}

constexpr double touching = 1e-9;  // m: nearer than this counts as overlap

}  // namespace

int World::add(std::shared_ptr<const Tree> mesh, const Pose<double>& pose, Filter filter) {
  if (!mesh || mesh->triangles().empty()) throw std::invalid_argument("a mesh without triangles");
  const Vec3 middle = (mesh->low() + mesh->high()) / 2, half = (mesh->high() - mesh->low()) / 2;
  const double arm = (middle.cwiseAbs() + half).norm();
  return add({std::move(mesh), pose, filter, true, middle, half, arm});
}

int World::add(const Shape& shape, const Pose<double>& pose, Filter filter, bool scenery) {
  const Vec3 half = shape.half() + Vec3::Constant(shape.radius());
  return add({shape, pose, filter, scenery, Vec3::Zero(), half, shape.reach() + shape.radius()});
}

int World::add(Collider collider) {
  Vec3 low, high;
  box_of(collider, low, high);
  colliders_.push_back(std::move(collider));
  move_of_.push_back(nullptr);
  broad_phase_.add(low, high);
  near_reach_ = -1;
  return size() - 1;
}

void World::place(int collider, const Pose<double>& pose) {
  Collider& c = colliders_[static_cast<std::size_t>(collider)];
  c.pose = pose;
  Vec3 low, high;
  box_of(c, low, high);
  broad_phase_.move(collider, low, high);
  near_reach_ = -1;
}

const Tree* World::mesh(int collider) const {
  const auto* tree = std::get_if<std::shared_ptr<const Tree>>(&at(collider).body);
  return tree ? tree->get() : nullptr;
}

void World::box_of(const Collider& c, Vec3& low, Vec3& high) const {
  const Vec3 middle = c.pose * c.middle, half = c.pose.rotation.cwiseAbs() * c.half;
  low = middle - half;
  high = middle + half;
}

bool World::looked_at(int a, int b) const {
  const Collider &x = at(a), &y = at(b);
  if (x.scenery && y.scenery) return false;
  if (shape(b) && b <= a) return false;  // two shapes are one pair
  return (x.filter.group & y.filter.mask) != 0 && (y.filter.group & x.filter.mask) != 0;
}

Course World::course(int collider) const {
  Course c{.start = pose(collider)};
  if (const Move* move = move_of_[static_cast<std::size_t>(collider)]) {
    c.twist = move->twist;
    c.path = move->path;
  }
  return c;
}

double World::travel(int collider) const {
  const Move* move = move_of_[static_cast<std::size_t>(collider)];
  if (!move) return 0;
  if (move->path) return move->path->speed + move->path->spin * at(collider).arm;
  return move->twist.head<3>().norm() + move->twist.tail<3>().norm() * at(collider).arm;
}

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
  const Pose<double>& place = motion.start().place;
  const std::size_t first = found.candidates.size();
  const bool moves = motion.travel() > 0;
  const double reach = moves ? std::max(activation, motion.travel() + 2 * margins_.stop) : activation;
  if (const Tree* tree = mesh(b)) {
    // A curved path leaves the chord between its ends by at most bend / 8.
    const double curve = motion.along_path() ? motion.travel() : motion.bend() / 8;
    Region region(shape, place,
                  shape.radius() + (moves ? std::max(activation, 2 * margins_.stop + curve) : activation));
    if (moves && !motion.along_path()) region.include(motion.at(1).place, margins_.stop + curve + shape.radius());
    const std::span<const TreeNode> nodes = tree->nodes();
    const std::span<const Triangle> triangles = tree->triangles();
    Region::Seen seen;
    for (std::size_t i = 0; i < nodes.size();) {
      const TreeNode& node = nodes[i];
      if (region.misses(node, seen)) {
        i = node.skip;
        continue;
      }
      if (shape.core() != Core::hull) {
        const auto [begin, end] = tree->range(i);
        Closest c;
        std::uint32_t nearest;
        if (end - begin <= patch_size &&
            stand_in(shape, region, seen, triangles.subspan(begin, end - begin), begin, margins_.stop, c, nearest)) {
          if (c.distance - shape.radius() <= reach) found.candidates.push_back({nearest, begin, end, c});
          i = node.skip;
          continue;
        }
      }
      ++i;
      for (std::uint32_t t = node.leaf / 8; t < node.leaf / 8 + node.leaf % 8; ++t) {
        Triangle local;
        for (std::size_t k = 0; k < 3; ++k)
          local.corner[k] = place.rotation.transpose() * (triangles[t].corner[k] - place.position);
        if (region.misses(local)) continue;
        Closest c = closest(shape, local, shape.radius() + reach);
        if (c.distance - shape.radius() > reach) continue;
        c.normal = place.rotation * c.normal;
        c.on_b = place * c.on_b;
        found.candidates.push_back({t, t, t + 1, c});
      }
    }
  } else {
    const Shape& other = *this->shape(b);
    const Closest c = closest(shape, place, {.shape = &other}, 0);
    if (c.distance - shape.radius() - other.radius() <= reach) found.candidates.push_back({0, 0, 1, c});
  }
  if (found.candidates.size() > first) found.pairs.push_back({a, b, first, found.candidates.size()});
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
      add(near_.candidates[i].closest, tree ? tree->origin(near_.candidates[i].triangle) : 0);
    if (tree) continue;
    const Relative now(course(pair.a), course(pair.b), 0);
    facing(*shape(pair.a), now.start().place, *shape(pair.b), near_.candidates[pair.first].closest, activation,
           facing_);
    for (int k = 0; k < facing_.count; ++k)
      add(facing_.at[static_cast<std::size_t>(k)], static_cast<std::uint32_t>(k + 1));
  }
  return touches_;
}

// A patch is first taken for all that lies beyond a plane that turns with the motion; only where that comes too near,
// its triangles are asked. These end the motion an eighth of the strip before a plane would: what lies in one plane,
// and a palm that is pressed on a fine flat mesh has thousands of patches there, then keeps off as a whole.
double World::safe_time(const Pair& pair, const Candidate& candidate, const Relative& motion, Strip strip,
                        double limit) const {
  const Shape& a = *shape(pair.a);
  const Tree* tree = mesh(pair.b);
  if (!tree) return collision::safe_time(a, motion, {.shape = shape(pair.b)}, candidate.closest, strip, limit);
  if (candidate.end - candidate.first == 1)
    return collision::safe_time(a, motion, {.triangle = &tree->triangles()[candidate.triangle]}, candidate.closest,
                                strip, limit);
  const std::span<const Triangle> patch = tree->triangles().subspan(candidate.first, candidate.end - candidate.first);
  if (!motion.along_path()) {
    constexpr int planes = 6;
    Relative::Instant now = motion.start();
    Closest plane = candidate.closest;
    double s = 0;
    for (int k = 0; k < planes; ++k) {
      const double room = plane.distance - a.radius() - strip.aim;
      if (!(room > 0)) break;
      s += free_way(a, motion, now, plane.normal, room);
      if (s >= limit) return limit;
      now = motion.at(s);
      plane = plane_between(a, now.place, patch, plane.on_b);
    }
  }
  strip.aim += (strip.land - strip.aim) / 8;
  for (std::uint32_t t = candidate.first; t < candidate.end; ++t) {
    const Part part{.triangle = &tree->triangles()[t]};
    const Closest start = closest(a, motion.start().place, part, a.radius() + motion.travel() + strip.land);
    if (start.distance - a.radius() > motion.travel() + strip.land) continue;
    limit = collision::safe_time(a, motion, part, start, strip, limit);
  }
  return limit;
}

TimeOfContact World::time_of_contact(std::span<const Move> moves) {
  std::fill(move_of_.begin(), move_of_.end(), nullptr);
  for (const Move& move : moves) {
    if (move.collider < 0 || move.collider >= size())
      throw std::invalid_argument("no collider " + std::to_string(move.collider) + ", there are " +
                                  std::to_string(size()));
    if (!move.path && !move.twist.allFinite())
      throw std::invalid_argument("the twist of collider " + std::to_string(move.collider) + " is not finite");
    move_of_[static_cast<std::size_t>(move.collider)] = &move;
  }
  double most = 0, second = 0;  // two of them may approach each other
  for (const Move& move : moves) {
    const double d = travel(move.collider);
    second = std::max(second, std::min(d, most));
    most = std::max(most, d);
  }
  const bool known = most + second + 2 * margins_.stop <= near_reach_;
  if (!known) collect(0, swept_);
  const Found& found = known ? near_ : swept_;

  least_.assign(colliders_.size(), std::numeric_limits<double>::infinity());
  for (const Pair& pair : found.pairs) {
    const double radius = shape(pair.a)->radius() + (mesh(pair.b) ? 0 : shape(pair.b)->radius());
    double& least = least_[static_cast<std::size_t>(pair.a)];
    for (std::size_t i = pair.first; i < pair.end; ++i)
      least = std::min(least, found.candidates[i].closest.distance - radius);
    if (!mesh(pair.b))
      least_[static_cast<std::size_t>(pair.b)] = std::min(least_[static_cast<std::size_t>(pair.b)], least);
  }

  TimeOfContact out;
  for (const Pair& pair : found.pairs) {
    const Course of_a = course(pair.a), of_b = course(pair.b);
    if (of_a.still() && of_b.still()) continue;
    const Shape& shape = *this->shape(pair.a);
    const Relative motion(of_a, of_b, shape.reach());
    const double radius = shape.radius() + (mesh(pair.b) ? 0 : this->shape(pair.b)->radius());
    double least = least_[static_cast<std::size_t>(pair.a)];
    if (!mesh(pair.b)) least = std::min(least, least_[static_cast<std::size_t>(pair.b)]);
    const Strip strip = landing(least, margins_.stop);
    for (std::size_t i = pair.first; i < pair.end; ++i) {
      const Candidate& candidate = found.candidates[i];
      const double gap = candidate.closest.distance - radius;
      if (gap > motion.travel() + strip.land) continue;
      if (gap <= touching) return {0, pair.a, pair.b, true};
      const double time = safe_time(pair, candidate, motion, strip, out.time);
      if (time < out.time) out = {time, pair.a, pair.b, false};
    }
  }
  return out;
}

}  // namespace zwang::collision
