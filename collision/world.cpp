#include <zwang/collision/world.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <zwang/collision/patch.h>

namespace zwang::collision {
namespace {

constexpr double touching = 1e-9;  // m: nearer than this counts as overlap

}  // namespace

int World::add(std::shared_ptr<const Tree> mesh, const Pose<double>& pose, Filter filter) {
  if (!mesh || mesh->size() == 0) throw std::invalid_argument("a mesh without triangles");
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

// A patch is first taken for all that lies beyond a plane that turns with the motion; only where that comes too near,
// its triangles are asked. These end the motion an eighth of the strip before a plane would: what lies in one plane,
// and a palm that is pressed on a fine flat mesh has thousands of patches there, then keeps off as a whole.
double World::safe_time(const Pair& pair, const Candidate& candidate, const Relative& motion, Strip strip,
                        double limit) const {
  const Shape& a = *shape(pair.a);
  const Tree* tree = mesh(pair.b);
  if (!tree) return collision::safe_time(a, motion, {.shape = shape(pair.b)}, candidate.closest, strip, limit);
  if (candidate.end - candidate.first == 1) {
    const Triangle triangle = tree->triangle(candidate.first);
    return collision::safe_time(a, motion, {.triangle = &triangle}, candidate.closest, strip, limit);
  }
  const std::span<const Vec3> patch = tree->points(candidate.first, candidate.end);
  if (!motion.along_path()) {
    constexpr int planes = 6;
    Relative::Instant now = motion.start();
    Closest plane = candidate.closest;
    double s = 0;
    for (int k = 0; k < planes; ++k) {
      const double room = plane.distance - a.radius() - strip.aim;
      if (!(room > 0)) break;
      s += free_way(a, motion, now, plane.normal, room, limit - s);
      if (s >= limit) return limit;
      now = motion.at(s);
      plane = plane_between(a, now.place, patch, plane.on_b);
    }
  }
  strip.aim += (strip.land - strip.aim) / 8;
  for (const Triangle& triangle : tree->triangles(candidate.first, candidate.end)) {
    const Part part{.triangle = &triangle};
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
