#pragma once

#include <algorithm>
#include <functional>
#include <span>

#include <zwang/collision/closest.h>

namespace zwang::collision {

// A motion over the step that is no twist: pose(s) for s in [0, 1], pose(0) the collider's own, with bounds on how fast
// it goes anywhere on the way.
struct Path {
  std::function<Pose<double>(double)> pose = {};
  double speed = 0;  // m per step, of the body's origin
  double spin = 0;   // rad per step
};

// How one body moves over the step: x(s) = retract(pose, s * twist), or along a path.
struct Course {
  Pose<double> start = {};
  Vec<double, 6> twist = Vec<double, 6>::Zero();  // m, rad over the whole step, world axes
  const Path* path = nullptr;                     // in place of the twist

  Pose<double> at(double s) const;
  bool still() const { return path == nullptr && twist.isZero(0); }
};

// A as B sees it: everything in B's axes, in which B's parts stand still.
class Relative {
 public:
  // arm: the farthest corner of A's core from its origin [m].
  Relative(const Course& a, const Course& b, double arm);

  // A's pose and, for twists, its velocity there: a point q of A (its axes) moves with drift + turn x (rotation * q).
  struct Instant {
    Pose<double> place;
    Vec3 drift = Vec3::Zero(), turn = Vec3::Zero();
  };
  const Instant& start() const { return start_; }
  Instant at(double s) const;

  // No point of A's core goes farther than this, as B sees it [m].
  double travel() const { return travel_; }
  // A bound on the acceleration of any of them [m per step^2]; twists only.
  double bend() const { return bend_; }
  bool along_path() const { return a_.path != nullptr || b_.path != nullptr; }

 private:
  Course a_, b_;
  double bend_ = 0, travel_ = 0;
  Instant start_;
};

// A part of B: the corners of a triangle, or of a shape's core, and the radius that sweeps it.
struct Part {
  const Triangle* triangle = nullptr;
  const Shape* shape = nullptr;
};
Closest closest(const Shape& a, const Pose<double>& a_in_b, const Part& part, double reach);  // in B's axes
inline double radius_of(const Part& part) { return part.shape ? part.shape->radius() : 0; }

// Where a motion ends: at a gap between `aim` and `land` [m].
struct Strip {
  double land, aim;
};
// Of a body whose nearest neighbour is `gap` away at the start: between half the stop distance and the whole of it.
// What starts nearer than twice the stop distance may still come gap^2 / (4 stop) nearer, and half of that again: so
// that resting bodies may slide, yet n motions that all press on leave a gap of more than 2 stop / n.
inline Strip landing(double gap, double stop) {
  const double room = gap < 2 * stop ? gap * gap / (4 * stop) : gap - stop;
  return {gap - room, gap - room - std::min(room, stop) / 2};
}

// How far from `now` on the core's corners keep `room` [m] over a plane that the lowest of them is `room` above, across
// n (B's axes); infinite where none comes down to it within `most`. What lies beyond that plane is met by nobody until
// then. Twists only.
double free_way(const Shape& a, const Relative& motion, const Relative::Instant& now, const Vec3& n, double room,
                double most);

// How far along [0, limit] the shape may go before the gap to the part (from `start`) falls to
// strip.land. Directional conservative advancement, after Mirtich (1996) and Zhang, Lee & Kim (2006): over a step h
// every corner a of the core keeps the separation along the present normal n
//
//   n . a(h) - max_b n . b  >=  s_a + h n . v_a - 1/2 h^2 bend
//
// so the largest h for which all of them stay over strip.aim is safe, and motion along or away from the
// surface costs nothing. It ends where the gap is between aim and land: a strip in place of a
// tolerance, reached in a few steps. Corners one by one, not the fastest point against the nearest gap: a
// long capsule that turns about its touching end is not held back by the other end. Along a path only its speed bound
// is known, and h = (gap - aim) / bound. Never late: in doubt (10,000 steps) it stops where it is.
double safe_time(const Shape& a, const Relative& motion, const Part& part, Closest start, Strip strip, double limit);

}  // namespace zwang::collision
