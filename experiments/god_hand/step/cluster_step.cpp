#include <algorithm>

#include <zwang/core/model/motion.h>
#include <zwang/experiments/god_hand/step/cluster.h>
#include <zwang/experiments/god_hand/step/lap.h>

// A sub-step of a cluster: how far it goes of what the solve says, and its commit cycle.

namespace zwang::god {
namespace {

constexpr double leg = 0.25;    // rad
constexpr double still = 1e-7;  // m: what moves by less rests

// No point of the shape goes farther than this.
double travel(const collision::Shape& shape, const Vec<double, 6>& twist) {
  return twist.head<3>().norm() + twist.tail<3>().norm() * reach_of(shape);
}

}  // namespace

double Cluster::longest(std::span<const Vec<double, 6>> ways) const {
  double most = 0;
  for (std::size_t b = 0; b < size(); ++b) most = std::max(most, travel(objects_.shapes[b], ways[b]));
  return most;
}

void Cluster::slow_down() { caution_ = std::max(caution_ / 2, still / allowed_); }

// The motion of a cluster that presses: half as far again as its targets went in this frame, at least at a metre a
// second to catch up with, at most what contacts are looked for over. Where it turns back on itself, as between two
// contacts that the linear rows put too far apart, it is bounded to half as much each time, but never below its
// targets' pace. A cluster at rest trembles by nanometres, to and fro: bounded to half of that again and again, it
// would follow no target that comes back elsewhere.
void Cluster::bound() {
  const double most = longest(way_);
  double along = 0;
  for (std::size_t b = 0; b < size(); ++b) along += way_[b].head<3>().dot(last_way_[b].head<3>());
  if (along < 0 && most > std::max(pace_, still))
    slow_down();
  else
    caution_ = std::min(1.0, 1.5 * caution_);
  const double allowed = std::max(caution_ * allowed_, pace_);
  if (most <= allowed) return;
  for (std::size_t b = 0; b < size(); ++b) way_[b] *= allowed / most;
}

// Gauss' function of what is left to the targets from the poses, less a motion [kg m^2].
double Cluster::constraint(std::span<const Pose<double>> poses, std::span<const Vec<double, 6>> less) const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    const Body& body = objects_.scene.bodies[b];
    const Vec<double, 6> left = twist_between(poses[b], target_[b]) - less[b];
    const Vec3 turn = poses[b].rotation.transpose() * left.tail<3>();
    sum += (body.mass * left.head<3>().squaredNorm() + turn.dot(body.inertia * turn)) / 2;
  }
  return sum;
}

// The linear step does not know that joints bend it: a finger that hangs 30 mm behind its target overshoots by more
// than it came to mend, and trembles or worse (Gauss-Newton with a large residual). So the candidate is weighed: D is
// how much higher Gauss' function is there than the linear step promised, |v|^2 the step's own norm. Along the step it
// is then E0 - s |v|^2 + s^2 (|v|^2 / 2 + D), least at s = 1 / (1 + 2 D / |v|^2). Where nothing bends, as when a hand
// slides, D = 0 and the step stays whole.
void Cluster::damp(Frame& frame) {
  candidate(1, frame);
  const Lap lap(frame.times.other);
  std::fill(screw_.begin(), screw_.end(), Vec<double, 6>::Zero());
  const double bent = constraint(end_, screw_) - constraint(pose_, way_);
  double norm = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    const Body& body = objects_.scene.bodies[b];
    const Vec3 turn = pose_[b].rotation.transpose() * way_[b].tail<3>();
    norm += body.mass * way_[b].head<3>().squaredNorm() + turn.dot(body.inertia * turn);
  }
  if (bent <= 1e-9 * constraint(pose_, screw_) || norm == 0) return;  // the solver's rounding of the joints
  for (std::size_t b = 0; b < size(); ++b) way_[b] /= 1 + 2 * bent / norm;
}

// Straight to the targets, by a quarter of a radian at a time: on longer screws, each about its own centre, bodies that
// turn together would run through each other. Returns whether there is more to go.
bool Cluster::go_freely() {
  double turn = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    way_[b] = twist_between(pose_[b], target_[b]);
    turn = std::max(turn, way_[b].tail<3>().norm());
  }
  if (turn <= leg) return false;
  for (std::size_t b = 0; b < size(); ++b) way_[b] *= leg / turn;
  return true;
}

bool Cluster::way_is_clear() {
  for (std::size_t b = 0; b < size(); ++b) screw_[b] = twist_between(pose_[b], target_[b]);
  return encounters_.time_of_contact(screw_) == 1;
}

// end_ = that part of the way, put onto the joints; screw_ = how each body gets there.
void Cluster::candidate(double part, Frame& frame) {
  const Lap lap(frame.times.other);
  for (std::size_t b = 0; b < size(); ++b) {
    screw_[b] = part * way_[b];
    end_[b] = retract(pose_[b], screw_[b]);
  }
  if (printed()) return;
  skeleton_.close(end_, options_.limits == Options::Limits::predictive);
  for (std::size_t b = 0; b < size(); ++b) screw_[b] = twist_between(pose_[b], end_[b]);
}

double Cluster::sweep(Frame& frame) {
  const Lap lap(frame.times.sweep);
  return encounters_.time_of_contact(screw_);
}

// The way straight to the targets is for a hand in the air. A finger that unrolls along it by a quarter of a radian may
// go down before it goes up, where the linear rows see it leave: what ends it is then nearer than what rows are written
// for, and the linear step, which they know, is taken instead. Otherwise the hand would creep toward that obstacle by
// ever smaller times of contact, and stay.
double Cluster::propose(Frame& frame) {
  {
    const Lap lap(frame.times.other);
    couple_to_targets(objects_.scene, target_, reaching_stiffness(options_.dt), z_u_);
  }
  {
    const Lap lap(frame.times.search);
    using Choice = Contacts::Choice;
    const Choice choice = !options_.reduce_contacts ? Choice::raw : options_.lazy_contacts ? Choice::few : Choice::all;
    // Two bodies may each go so far toward the other: the sweep then asks for nothing new.
    encounters_.look(std::max(options_.activation, 2.3 * allowed_), choice);
  }
  if (!counted_) {
    frame.raw += static_cast<int>(encounters_.raw());
    frame.kept += static_cast<int>(rows().size());
  }
  counted_ = true;
  solved_at_ = pose_;
  std::fill(way_.begin(), way_.end(), Vec<double, 6>::Zero());
  leg_ = free_ = false;
  if (!solve_lazily(frame)) {
    std::fill(way_.begin(), way_.end(), Vec<double, 6>::Zero());
    candidate(1, frame);
    return 1;
  }
  const bool pressing = presses();
  if (!printed() && !bent_ && (!pressing || !blocked_)) {
    leg_ = go_freely();
    candidate(1, frame);
    const double toc = sweep(frame);
    free_ = toc == 1 || (!pressing && toc * longest(screw_) > options_.activation);
    if (free_) {
      solution_.lambda.setZero();  // nothing is held back
      return toc;
    }
    leg_ = false;
    take_solution();
  }
  bent_ = false;
  blocked_ = pressing;
  if (!printed()) damp(frame);
  bound();
  candidate(1, frame);
  return sweep(frame);
}

// The TOC counts once, or twice as Eq. 29-30 print it. As printed, the linear step is cut there and that is all: what
// lies before a time of contact is clear. In the cycle the end at that part of the way is put onto the joints, which
// changes the way: it is swept again from the start, and cut again, somewhat shorter, where it meets something. What is
// left of the bend then shrinks with the square of the step: after a held one, shorter steps are taken. A
// free way of which next to nothing is left is not gone: a linear step is taken in its place.
void Cluster::commit(double toc, Frame& frame) {
  double part = options_.toc_twice ? toc * toc : toc;
  if (part < 1 || !leg_) ++sub_step_;
  frame.sub_steps = std::max(frame.sub_steps, sub_step_);
  done_ = sub_step_ == options_.sub_steps || (part == 1 && !leg_);
  held_ = !solved_;
  bool clear = part == 1;
  if (printed()) candidate(part, frame), clear = true;
  for (const double less : {0.99, 0.9, 0.5}) {
    if (clear) break;
    part *= less;
    candidate(part, frame);
    const double again = sweep(frame);
    clear = again == 1;
    part *= again;
  }
  if (free_ && part < 1 && (!clear || longest(screw_) <= options_.activation)) {
    bent_ = true;
    --sub_step_;
    done_ = false;
    return;
  }
  if (!clear) {
    held_ = true;
    slow_down();
    pace_ /= 2;
    return;
  }
  const Lap lap(frame.times.sweep);
  for (std::size_t b = 0; b < size(); ++b) {
    last_way_[b] = screw_[b];
    objects_.scene.bodies[b].pose = pose_[b] = end_[b];
    encounters_.place(static_cast<BodyId>(b), pose_[b]);
  }
}

}  // namespace zwang::god
