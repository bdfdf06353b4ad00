#include <zwang/collision/world.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

namespace zwang::collision {
namespace {

constexpr double touching = 1e-9;  // m: nearer than this counts as overlap

// How often a plane is put anew along a motion: of a patch while that is cheaper than its triangles, of slivers as
// often as it pays; the limit is for motions that start a hair's breadth away, where a plane has next to no room.
constexpr int patch_planes = 6, sliver_planes = 1000;

// The least of `limit` and the safe times of some triangles, which are clear until `from`.
double past_triangles(const Shape& a, const RelativeMotion& motion, const RelativeMotion::Instant& from,
                      const Tree& tree, std::pair<std::uint32_t, std::uint32_t> some, StopRange range, double limit) {
  range.aim += (range.land - range.aim) / 8;
  for (const Triangle& triangle : tree.triangles(some)) {
    const Obstacle obstacle{.triangle = &triangle};
    const double near = a.radius() + motion.travel() * (limit - from.s) + range.land;
    const Closest now = closest(a, from.place, obstacle, near);
    if (now.distance <= near) limit = safe_time(a, motion, from, obstacle, now, range, limit);
  }
  return limit;
}

// The same of a patch, `plane` over it.
double past_patch(const Shape& a, const RelativeMotion& motion, const Tree& tree,
                  std::pair<std::uint32_t, std::uint32_t> some, Closest plane, StopRange range, double limit) {
  RelativeMotion::Instant now = motion.start();
  for (int k = 0; k < patch_planes && !motion.along_path(); ++k) {
    const double room = plane.distance - a.radius() - range.aim;
    if (!(room > 0)) break;
    const double s = now.s + time_to_plane(a, motion, now, plane.normal, room, limit);
    if (s >= limit) return limit;
    now = motion.at(s);
    plane = plane_between(a, now.place, tree.points(some.first, some.second), plane.on_b);
  }
  return past_triangles(a, motion, motion.start(), tree, some, range, limit);
}

// The same of the slivers of a subtree, `plane` over them. It is put anew as long as it keeps off more than it loses
// against the one sliver that it lies on; then the halves go on from there with planes of their own, the nearer first,
// down to the leaves.
double past_slivers(const Shape& a, const RelativeMotion& motion, RelativeMotion::Instant now, const Tree& tree,
                    std::size_t node, PlaneOver plane, StopRange range, double limit) {
  const auto over = [&](std::size_t of) {
    return plane_over(a, now.place, tree, of, a.radius() + motion.travel() * (limit - now.s) + range.land);
  };
  if (limit <= now.s) return limit;
  for (int k = 0; k < sliver_planes; ++k) {
    if (plane.distance - a.radius() > motion.travel() * (limit - now.s) + range.land) return limit;
    if (now.s > 0 && plane.most - a.radius() <= range.land) return now.s;
    const double room = plane.distance - a.radius() - range.aim;
    if (!(room > 0 && room >= plane.most - plane.distance)) break;
    const double s = now.s + time_to_plane(a, motion, now, plane.normal, room, limit);
    if (s >= limit) return limit;
    if (s <= now.s) break;
    now = motion.at(s);
    plane = over(node);
  }
  if (tree.leaf(node)) return past_triangles(a, motion, now, tree, tree.range(node), range, limit);
  std::array halves{node + 1, std::size_t{tree.nodes()[node + 1].skip}};
  std::array planes{over(halves[0]), over(halves[1])};
  if (planes[1].distance < planes[0].distance) std::swap(planes[0], planes[1]), std::swap(halves[0], halves[1]);
  for (std::size_t k = 0; k < 2; ++k) limit = past_slivers(a, motion, now, tree, halves[k], planes[k], range, limit);
  return limit;
}

}  // namespace

int World::add(std::shared_ptr<const Tree> mesh, const Pose<double>& pose, Filter filter) {
  if (!mesh || mesh->size() == 0) throw std::invalid_argument("a mesh without triangles");
  const Vec3 middle = mesh->box().center(), half = mesh->box().sizes() / 2;
  const double arm = (middle.cwiseAbs() + half).norm();
  return add({std::move(mesh), pose, filter, true, middle, half, arm});
}

int World::add(const Shape& shape, const Pose<double>& pose, Filter filter, bool scenery) {
  const Vec3 half = shape.half() + Vec3::Constant(shape.radius());
  return add({shape, pose, filter, scenery, Vec3::Zero(), half, shape.reach() + shape.radius()});
}

int World::add(Collider collider) {
  const Eigen::AlignedBox3d box = box_of(collider);
  colliders_.push_back(std::move(collider));
  move_of_.push_back(nullptr);
  broad_phase_.add(box.min(), box.max());
  near_reach_ = -1;
  return size() - 1;
}

void World::place(int collider, const Pose<double>& pose) {
  Collider& c = colliders_[static_cast<std::size_t>(collider)];
  c.pose = pose;
  const Eigen::AlignedBox3d box = box_of(c);
  broad_phase_.move(collider, box.min(), box.max());
  near_reach_ = -1;
}

const Tree* World::mesh(int collider) const {
  const auto* tree = std::get_if<std::shared_ptr<const Tree>>(&at(collider).body);
  return tree ? tree->get() : nullptr;
}

Eigen::AlignedBox3d World::box_of(const Collider& c) {
  const Vec3 middle = c.pose * c.middle, half = c.pose.rotation.cwiseAbs() * c.half;
  return {middle - half, middle + half};
}

bool World::may_meet(int a, int b) const {
  const Collider &x = at(a), &y = at(b);
  if (x.scenery && y.scenery) return false;
  if (shape(b) && b <= a) return false;  // two shapes are one pair
  return x.filter.meets(y.filter);
}

BodyMotion World::body_motion(int collider) const {
  const Move* move = move_of_[zwang::at(collider)];
  return move ? BodyMotion{pose(collider), move->twist, move->path} : BodyMotion{pose(collider)};
}

double World::travel(int collider) const {
  const Move* move = move_of_[static_cast<std::size_t>(collider)];
  if (!move) return 0;
  if (move->path) return move->path->speed + move->path->spin * at(collider).arm;
  return move->twist.head<3>().norm() + move->twist.tail<3>().norm() * at(collider).arm;
}

// The pairs of each shape and what is near it or, with moves, near its sweep.
void World::collect(double activation, Found& found) {
  found.pairs.clear();
  found.candidates.clear();
  double others = 0;
  for (int c = 0; c < size(); ++c) others = std::max(others, travel(c));
  for (int a = 0; a < size(); ++a) {
    if (!shape(a)) continue;
    const Eigen::AlignedBox3d box = box_of(at(a));
    const Vec3 margin = Vec3::Constant(activation + 2 * margins_.stop + travel(a) + others);
    broad_phase_.query(box.min() - margin, box.max() + margin, overlapping_);
    for (const int b : overlapping_)
      if (may_meet(a, b)) collect_pair(a, b, activation, found);
  }
}

void World::collect_pair(int a, int b, double activation, Found& found) const {
  const Shape& shape = *this->shape(a);
  const RelativeMotion motion(body_motion(a), body_motion(b), shape.reach());
  const std::size_t first = found.candidates.size();
  const bool moves = motion.travel() > 0;
  const double reach = moves ? std::max(activation, motion.travel() + 2 * margins_.stop) : activation;
  if (const Tree* tree = mesh(b)) {
    // A curved path leaves the chord between its ends by at most acceleration / 8.
    const double curve = motion.along_path() ? motion.travel() : motion.acceleration() / 8;
    Region region(shape, motion.start().place,
                  shape.radius() + (moves ? std::max(activation, 2 * margins_.stop + curve) : activation));
    if (moves && !motion.along_path()) region.include(motion.at(1).place, margins_.stop + curve + shape.radius());
    collect_mesh(*tree, region, reach, moves, found.candidates);
  } else {
    const Shape& other = *this->shape(b);
    const Closest c = closest(shape, motion.start().place, {.shape = &other}, 0);
    if (c.distance - shape.radius() - other.radius() <= reach) found.candidates.push_back({0, 1, 0, {c}});
  }
  if (found.candidates.size() > first) found.pairs.push_back({a, b, first, found.candidates.size()});
}

// The patches (where one plane is accurate enough) and triangles of a mesh within `reach` of the region's shape.
void World::collect_mesh(const Tree& tree, const Region& region, double reach, bool swept,
                         std::vector<Candidate>& candidates) const {
  const Shape& shape = region.shape;
  const Pose<double>& place = region.a_in_b;
  const auto enter = [&](const TreeNode& node, std::size_t number) {
    Region::LocalBox box;
    if (region.misses(node, box)) return false;
    if (const Slab* slab = tree.slab(number); slab && region.misses(*slab)) return false;
    const auto [begin, end] = tree.range(number);
    if (shape.core() == Core::hull) return true;
    if (tree.of_slivers()) {
      // A body flat on many keeps touches at several places: about one alone it would turn until a sweep stops it.
      if (!swept && end - begin > patch_size && node.width() > (shape.reach() + shape.radius()) / 4) return true;
      const PlaneOver plane = plane_over(shape, place, tree, number, shape.radius() + reach);
      const double gap = plane.distance - shape.radius(), most = plane.most - shape.radius();
      if (gap > reach) return false;
      // A sweep asks for no more than stop_range() does.
      const double slack = (gap > margins_.stop / 2 ? margins_.stop + gap : gap) / 10;
      if (!(gap > touching && most < reach && most - gap <= slack) && !(swept && gap >= 2 * margins_.stop)) return true;
      candidates.push_back({begin, end, number, plane});
      return false;
    }
    Closest c;
    if (end - begin > patch_size || !patch_plane(region, box, tree.points(begin, end), margins_.stop, c)) return true;
    if (c.distance - shape.radius() <= reach) candidates.push_back({begin, end, number, {c}});
    return false;
  };
  tree.walk(enter, [&](std::uint32_t begin, std::uint32_t end) {
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
      candidates.push_back({t, t + 1, 0, {c}});
    }
  });
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
    const RelativeMotion now(body_motion(pair.a), body_motion(pair.b), 0);
    face_contacts(*shape(pair.a), now.start().place, *shape(pair.b), near_.candidates[pair.first].closest, activation,
                  face_contacts_);
    for (int k = 0; k < face_contacts_.count; ++k)
      add(face_contacts_.at[static_cast<std::size_t>(k)], static_cast<std::uint32_t>(k + 1));
  }
  return touches_;
}

// A patch is first replaced by a separating plane, updated along the motion; only where the shape may reach that plane
// are its triangles tested. Those stop the motion an eighth of the range earlier than a plane would: otherwise a palm
// pressed on a fine flat mesh, with thousands of patches, would be tested against the triangles of each.
double World::safe_time(const Pair& pair, const Candidate& candidate, const RelativeMotion& motion, StopRange range,
                        double limit) const {
  const Shape& a = *shape(pair.a);
  const Tree* tree = mesh(pair.b);
  const auto past = [&](const Obstacle& obstacle) {
    return collision::safe_time(a, motion, motion.start(), obstacle, candidate.closest, range, limit);
  };
  if (!tree) return past({.shape = shape(pair.b)});
  if (candidate.end - candidate.first == 1) {
    const Triangle triangle = tree->triangle(candidate.first);
    return past({.triangle = &triangle});
  }
  if (tree->of_slivers())
    return past_slivers(a, motion, motion.start(), *tree, candidate.node, candidate.closest, range, limit);
  return past_patch(a, motion, *tree, {candidate.first, candidate.end}, candidate.closest, range, limit);
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
    if (!mesh(pair.b)) least_[zwang::at(pair.b)] = std::min(least_[zwang::at(pair.b)], least);
  }

  order_.reserve(found.candidates.capacity());
  TimeOfContact out;
  for (const Pair& pair : found.pairs) {
    const BodyMotion of_a = body_motion(pair.a), of_b = body_motion(pair.b);
    if (of_a.still() && of_b.still()) continue;
    const Shape& shape = *this->shape(pair.a);
    const RelativeMotion motion(of_a, of_b, shape.reach());
    const double radius = shape.radius() + (mesh(pair.b) ? 0 : this->shape(pair.b)->radius());
    double least = least_[static_cast<std::size_t>(pair.a)];
    if (!mesh(pair.b)) least = std::min(least, least_[static_cast<std::size_t>(pair.b)]);
    const StopRange range = stop_range(least, margins_.stop);
    order_.clear();
    for (std::size_t i = pair.first; i < pair.end; ++i) {
      const double gap = found.candidates[i].closest.distance - radius;
      if (gap <= touching) return {0, pair.a, pair.b, true};
      if (gap <= motion.travel() + range.land) order_.push_back(i);
    }
    // Slivers are met in the order in which they lie side by side: from the far end on, each would take a little more
    // off the time.
    if (const Tree* tree = mesh(pair.b); tree && tree->of_slivers())
      std::ranges::sort(order_, {}, [&](std::size_t i) { return std::pair(found.candidates[i].closest.distance, i); });
    for (const std::size_t i : order_) {
      const Candidate& candidate = found.candidates[i];
      const double time = safe_time(pair, candidate, motion, range, out.time);
      if (time < out.time) out = {time, pair.a, pair.b, false};
    }
  }
  return out;
}

}  // namespace zwang::collision
