#include <zwang/collision/narrow_phase/approach.h>

#include <cmath>
#include <limits>

namespace zwang::collision {
namespace {

constexpr int most_steps = 10000;

Pose<double> in(const Pose<double>& b, const Pose<double>& a) {
  return {b.rotation.transpose() * (a.position - b.position), b.rotation.transpose() * a.rotation};
}

// The largest h >= 0 with spare + rate h - 1/2 bend h^2 >= 0, spare > 0.
double reached(double spare, double rate, double acceleration) {
  const double root = std::sqrt(rate * rate + 2 * acceleration * spare);
  if (rate < 0) return 2 * spare / (root - rate);
  return acceleration > 0 ? (rate + root) / acceleration : std::numeric_limits<double>::infinity();
}

double speed(const BodyMotion& c) { return c.path ? c.path->speed : c.twist.head<3>().norm(); }
double spin(const BodyMotion& c) { return c.path ? c.path->spin : c.twist.tail<3>().norm(); }

}  // namespace

Pose<double> BodyMotion::at(double s) const {
  if (path) return path->pose(s);
  return s == 0 || still() ? start : retract(start, Vec<double, 6>(s * twist));
}

// B's axes turn: d^2/ds^2 [R_B' (a - x_B)] = R_B' (a'' - 2 w_B x (a - x_B)' + w_B x (w_B x (a - x_B))), with
// |a''| <= |w_A|^2 arm, and a - x_B no longer than at the start plus all that both may move.
RelativeMotion::RelativeMotion(const BodyMotion& a, const BodyMotion& b, double arm) : a_(a), b_(b) {
  const double turn_a = spin(a), turn_b = spin(b);
  const double apart = a.path || b.path ? speed(a) + speed(b) : Vec3(a.twist.head<3>() - b.twist.head<3>()).norm();
  const double point = apart + turn_a * arm;  // of a point of A against B's origin
  const double lever = (a.start.position - b.start.position).norm() + arm + point;
  acceleration_ = turn_a * turn_a * arm + 2 * turn_b * point + turn_b * turn_b * lever;
  travel_ = point + turn_b * lever;
  start_ = at(0);
}

RelativeMotion::Instant RelativeMotion::at(double s) const {
  const Pose<double> b = b_.at(s);
  Instant now{s, in(b, a_.at(s))};
  if (along_path()) return now;
  const Vec3 w_b = b.rotation.transpose() * b_.twist.tail<3>();
  now.turn = b.rotation.transpose() * a_.twist.tail<3>() - w_b;
  now.drift = b.rotation.transpose() * (a_.twist.head<3>() - b_.twist.head<3>()) - w_b.cross(now.place.position);
  return now;
}

Closest closest(const Shape& a, const Pose<double>& a_in_b, const Obstacle& obstacle, double reach) {
  Closest c;
  if (obstacle.triangle) {
    Triangle local;
    for (std::size_t k = 0; k < 3; ++k)
      local.corner[k] = a_in_b.rotation.transpose() * (obstacle.triangle->corner[k] - a_in_b.position);
    c = closest(a, local, reach);
  } else {
    std::array<Vec3, 64> local;
    const std::span<const Vec3> corners = obstacle.shape->corners();
    for (std::size_t k = 0; k < corners.size(); ++k)
      local[k] = a_in_b.rotation.transpose() * (corners[k] - a_in_b.position);
    c = closest(a.corners(), std::span<const Vec3>(local.data(), corners.size()));
  }
  c.normal = a_in_b.rotation * c.normal;
  c.on_b = a_in_b * c.on_b;
  return c;
}

double time_to_plane(const Shape& a, const RelativeMotion& motion, const RelativeMotion::Instant& now, const Vec3& n,
                     double room, double limit) {
  double lowest = std::numeric_limits<double>::infinity(), h = lowest;
  if (motion.along_path()) return motion.travel() > 0 ? room / motion.travel() : h;
  // n . v of a corner q is rate + turn . q.
  const double rate = n.dot(now.drift), most = limit - now.s;
  const Vec3 turn = now.place.rotation.transpose() * n.cross(now.turn), local = now.place.rotation.transpose() * n;
  const double slowest = rate - turn.norm() * a.reach();
  if (room + most * slowest - most * most * motion.acceleration() / 2 >= 0) return h;
  for (const Vec3& q : a.corners()) lowest = std::min(lowest, local.dot(q));
  for (const Vec3& q : a.corners())
    h = std::min(h, reached(room + (local.dot(q) - lowest), rate + turn.dot(q), motion.acceleration()));
  return h;
}

double safe_time(const Shape& a, const RelativeMotion& motion, RelativeMotion::Instant from, const Obstacle& obstacle,
                 Closest now, StopRange range, double limit) {
  const double radius = a.radius() + radius_of(obstacle);
  for (int step = 0; step < most_steps; ++step) {
    const double gap = now.distance - radius;
    if (from.s > 0 && gap <= range.land) break;
    const double s = from.s + time_to_plane(a, motion, from, now.normal, gap - range.aim, limit);
    if (s >= limit) return limit;
    if (s <= from.s) break;
    from = motion.at(s);
    now = closest(a, from.place, obstacle, std::numeric_limits<double>::infinity());
  }
  return from.s;
}

}  // namespace zwang::collision
