#pragma once

#include <algorithm>
#include <functional>

#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::collision {

// A motion over the step that is not a constant twist: pose(s) for s in [0, 1], with pose(0) the collider's own, and
// bounds on its speed over the whole step.
struct Path {
  std::function<Pose<double>(double)> pose = {};
  double speed = 0;  // m per step, of the body's origin
  double spin = 0;   // rad per step
};

// The motion of one body over the step: x(s) = retract(pose, s * twist), or along a path.
struct BodyMotion {
  Pose<double> start = {};
  Vec<double, 6> twist = Vec<double, 6>::Zero();  // m, rad over the whole step, world axes
  const Path* path = nullptr;                     // in place of the twist

  Pose<double> at(double s) const;
  bool still() const { return path == nullptr && twist.isZero(0); }
};

// The motion of A relative to B: everything in B's axes, in which B is at rest.
class RelativeMotion {
 public:
  // arm: the farthest corner of A's core from its origin [m].
  RelativeMotion(const BodyMotion& a, const BodyMotion& b, double arm);

  // A's pose at s and, for twists, its velocity: a point q of A (its axes) moves with drift + turn x (rotation * q).
  struct Instant {
    double s = 0;
    Pose<double> place = {};
    Vec3 drift = Vec3::Zero(), turn = Vec3::Zero();
  };
  const Instant& start() const { return start_; }
  Instant at(double s) const;

  // A bound on the path length of any point of A's core, relative to B [m].
  double travel() const { return travel_; }
  // A bound on the acceleration of any such point [m per step^2]; twists only.
  double acceleration() const { return acceleration_; }
  bool along_path() const { return a_.path != nullptr || b_.path != nullptr; }

 private:
  BodyMotion a_, b_;
  double acceleration_ = 0, travel_ = 0;
  Instant start_;
};

// What A may hit of B: a triangle, or a convex shape.
struct Obstacle {
  const Triangle* triangle = nullptr;
  const Shape* shape = nullptr;
};
Closest closest(const Shape& a, const Pose<double>& a_in_b, const Obstacle& obstacle, double reach);  // in B's axes
inline double radius_of(const Obstacle& obstacle) { return obstacle.shape ? obstacle.shape->radius() : 0; }

// A motion is stopped at a gap between `aim` and `land` [m].
struct StopRange {
  double land, aim;
};
// The range for a body whose nearest neighbour is `gap` away at the start: half the stop distance to the whole of it. A
// body that starts nearer than twice the stop distance may approach by gap^2 / (4 stop) to 1.5 times that. So resting
// bodies can slide, and after n steps that all press in the same direction the gap is still more than 2 stop / n.
inline StopRange stop_range(double gap, double stop) {
  const double room = gap < 2 * stop ? gap * gap / (4 * stop) : gap - stop;
  return {gap - room, gap - room - std::min(room, stop) / 2};
}

// How long from `now` no corner of the core reaches a plane with normal n (B's axes) that lies `room` [m] below the
// lowest corner; infinite where none reaches it before `limit`. Nothing beyond the plane is hit before.
double time_to_plane(const Shape& a, const RelativeMotion& motion, const RelativeMotion::Instant& now, const Vec3& n,
                     double room, double limit);

// The time in [from.s, limit] at which the gap to the obstacle (`now`: at `from`, before which it is not less than
// range.aim) falls to range.land. Directional conservative advancement, after Mirtich (1996) and Zhang, Lee & Kim
// (2006): over a step h every corner a of the core has, along the present normal n, the separation
//
//   n . a(h) - max_b n . b  >=  s_a + h n . v_a - 1/2 h^2 acceleration
//
// so the largest h for which all of them stay above range.aim is safe, and motion along or away from the surface is not
// limited. It ends where the gap is between aim and land: a range instead of a tolerance, reached in a few steps. Each
// corner has its own bound (not the fastest point against the smallest gap): a long capsule that turns about its
// touching end is not held back by the other end. Along a path only the bound on the speed is known, and
// h = (gap - aim) / bound. The result is never too late: after 10,000 steps it is the time reached.
double safe_time(const Shape& a, const RelativeMotion& motion, RelativeMotion::Instant from, const Obstacle& obstacle,
                 Closest now, StopRange range, double limit);

}  // namespace zwang::collision
