#include "bench/collision/drag.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/collision/hand_shapes.h"
#include "bench/scenes/physical.h"
#include "bench/suite/cpu_clock.h"
#include "constraints/contact.h"
#include "solvers/registry.h"

namespace zwang {
namespace {

using collision::Filter;
using collision::Move;
using collision::Shape;
using std::numbers::pi;

constexpr int hand_bodies = hand::bodies;
const double palm_half = hand::standard().palm_widths.z() / 2;  // m

constexpr std::uint64_t parts_bit = std::uint64_t{1} << 63;

std::uint64_t mixed(std::uint64_t h) {
  h = (h ^ (h >> 31)) * 0x9e3779b97f4a7c15u;
  return h ^ (h >> 29);
}

}  // namespace

HandDrag::HandDrag(std::vector<Part> parts, const DragOptions& options)
    : options_(options), parts_(std::move(parts)), solver_(make_solver("dual_active_set")) {
  low_ = Vec3::Constant(1e9), high_ = -low_;
  for (const Part& part : parts_) {
    const Vec3 middle = part.pose * Vec3((part.tree->low() + part.tree->high()) / 2);
    const Vec3 half = part.pose.rotation.cwiseAbs() * (part.tree->high() - part.tree->low()) / 2;
    low_ = low_.cwiseMin(middle - half);
    high_ = high_.cwiseMax(middle + half);
  }
  hand::Angles straight{};
  const Vec3 start = stage(0).middle;
  const Pose<double> above{{start.x(), start.y(), high_.z() + 0.06}, Mat3::Identity()};
  const hand::Poses poses = hand::assemble(above, straight);
  hand::add(scene_, poses);
  shapes_ = hand::shapes(hand::standard());
  std::array<Filter, hand_bodies> filters;
  for (std::size_t b = 0; b < filters.size(); ++b) filters[b] = {std::uint64_t{1} << b, ~std::uint64_t{0}};
  for (const auto& [a, b] : hand::passing(hand::standard())) {
    const auto one = static_cast<std::size_t>(a), other = static_cast<std::size_t>(b);
    filters[one].mask &= ~filters[other].group;
    filters[other].mask &= ~filters[one].group;
  }
  for (std::size_t b = 0; b < filters.size(); ++b) world_.add(shapes_[b], poses[b], filters[b]);
  for (const Part& part : parts_) {
    world_.add(part.tree, part.pose, {parts_bit, ~std::uint64_t{0}});
    ground_.add(part.tree, part.pose);
    Body body{.pose = part.pose, .motion = part.velocity.isZero(0) ? Motion::fixed : Motion::prescribed};
    scene_.add(body);
  }
  ground_.add(shapes_[0]);
  twist_.resize(scene_.bodies.size());
  for (Vec<double, 6>& t : twist_) t.setZero();
}

// The middle of what the target runs over at `way` [m] on its tour from part to part and back, and how far it swings.
HandDrag::Stage HandDrag::stage(double way) const {
  const auto of = [&](std::size_t p) {
    const collision::Tree& tree = *parts_[p].tree;
    const Vec3 size = parts_[p].pose.rotation.cwiseAbs() * (tree.high() - tree.low());
    return Stage{parts_[p].pose * Vec3((tree.low() + tree.high()) / 2), (0.3 * size).cwiseMax(Vec3::Constant(0.02))};
  };
  if (parts_.size() == 1) return of(0);
  const std::size_t last = parts_.size() - 1;
  for (std::size_t leg = 0;; leg = (leg + 1) % (2 * last)) {
    const Stage from = of(leg < last ? leg : 2 * last - leg), to = of(leg < last ? leg + 1 : 2 * last - leg - 1);
    const double length = (to.middle - from.middle).head<2>().norm();
    if (way > length) {
      way -= length;
      continue;
    }
    const double share = way / length;
    return {from.middle + share * (to.middle - from.middle), from.reach + share * (to.reach - from.reach)};
  }
}

// The height at which the palm, let down from above with these axes, comes to lie; where nothing is below it, as high
// as on the highest part.
double HandDrag::rest(const Vec3& at, const Mat3& axes) {
  constexpr double above = 0.1;  // m
  for (std::size_t p = 0; p < parts_.size(); ++p)
    ground_.place(static_cast<int>(p), world_.pose(hand_bodies + static_cast<int>(p)));
  const int palm = ground_.size() - 1;
  const double top = high_.z() + above;
  ground_.place(palm, {{at.x(), at.y(), top}, axes});
  Move down{palm};
  down.twist[2] = low_.z() - top;
  const double time = ground_.time_of_contact({&down, 1}).time;
  return time < 1 ? top + time * down.twist[2] : high_.z() + palm_half;
}

// Where the hand is tracked in this frame: on a Lissajous curve that wanders from part to part, the palm pressed below
// where it would come to rest, or lifted where the way ahead is higher, the fingers curling; or along a bar, closed
// about it deeper than it lets them, the thumb less: there every phalanx but the first ones is pressed on something,
// while on a flat surface a hand that lies on its palm touches with its finger tips at most.
void HandDrag::aim() {
  const double t = static_cast<double>(frame_) * options_.dt;
  const double lowered = std::min(1.0, t / 0.15);
  const bool grips = options_.grip > 0;
  Stage s = stage(options_.speed * t / 2);
  if (grips) s.reach.y() = 0;
  // The mean speed is about options_.speed.
  phase_ += (parts_.size() > 1 ? 0.5 : 1) * options_.speed * options_.dt / std::hypot(s.reach.x(), 0.7 * s.reach.y());
  Vec3 at = s.middle + Vec3(s.reach.x() * std::sin(phase_), s.reach.y() * std::sin(0.7 * phase_), 0);
  double turn = 0.4 * std::sin(0.3 * phase_) + (options_.spin > 0 ? std::sin(options_.spin * frame_) : 0);
  if (grips) turn *= 0.25, at.y() -= 0.045;
  const Mat3 axes = rotation(turn * Vec3::UnitZ()) * rotation(Vec3(grips ? -0.5 : 0.0, 0, 0));
  at.z() = high_.z() + palm_half - options_.depth * lowered;
  if (!grips) {
    constexpr double ahead = 0.02, step = 0.002, clear = 0.005;  // m
    const Vec3& palm = world_.pose(0).position;
    Vec3 next(at.x() - palm.x(), at.y() - palm.y(), 0);
    next = palm + next * std::min(1.0, ahead / std::max(next.norm(), 1e-9));
    const double here = rest(palm, axes), there = rest(next, axes);
    at.z() = there > here + step ? there + clear : here - options_.depth * lowered;
  }
  at.z() += 0.05 * (1 - lowered);
  hand::Angles angles{};
  for (int k = 0; k < hand::angles; ++k) {
    const double wave = 0.5 - 0.5 * std::cos(2 * pi * (0.7 + 0.05 * k) * t);
    const double share = grips ? lowered * options_.grip * (0.9 + 0.1 * wave) * (k < 4 ? 0.3 : 1.0) : 0.25 * wave;
    angles[static_cast<std::size_t>(k)] = k % 4 == 1 ? 0 : share * hand::range(k).high;
  }
  const hand::Poses poses = hand::assemble({at, axes}, angles);
  target_.assign(scene_.bodies.size(), Pose<double>{});
  std::copy(poses.begin(), poses.end(), target_.begin());
}

// z_u, scaled so that no point of the hand is asked to go farther in this frame than half as far again as the target
// goes: a hand that hangs behind an obstacle would otherwise be driven at it with all that it lags behind.
double HandDrag::limited_coupling() {
  couple_to_targets(scene_, target_, reaching_stiffness(options_.dt), z_u_);
  double most = 0;
  for (int b = 0; b < hand_bodies; ++b) {
    const Vec<double, 6> step = z_u_.segment<6>(6 * b) * options_.dt * options_.dt;
    const Shape& s = shapes_[static_cast<std::size_t>(b)];
    most = std::max(most, step.head<3>().norm() + step.tail<3>().norm() * (s.reach() + s.radius()));
  }
  const double allowed = 1.5 * options_.speed * options_.dt + 0.1 * options_.spin;
  if (most > allowed) z_u_ *= allowed / most;
  return std::min(most, allowed);
}

void HandDrag::write_rows(bool push) {
  auto& contacts = scene_.list_of<Contact>();
  contacts.all.clear();
  contacts.labels.clear();
  contacts.keys.clear();
  for (const std::uint32_t i : manifold_.kept()) {
    const collision::Touch& t = touches_[i];
    // Where pushing out to the whole gap contradicts itself (a wedge), rows only keep what gap there is.
    const double room = push ? t.gap - options_.gap : std::max(t.gap - options_.gap, 0.0);
    const std::uint64_t key =
        mixed(mixed(static_cast<std::uint64_t>(t.a) << 32 | static_cast<std::uint64_t>(t.b)) ^ t.feature);
    scene_.add(contact_at(scene_.bodies, t.a, t.b, t.point_a, t.normal, room), "touch", key);
  }
}

bool HandDrag::solve() {
  for (const bool push : {true, false}) {
    write_rows(push);
    assembler_.assemble(scene_, z_u_, {.dt = options_.dt}, problem_);
    solver_.solve(problem_, {.warm_start = &warm_}, solution_);
    if (solution_.status == Status::solved) break;
  }
  if (solution_.status != Status::solved) return false;
  warm_.key = problem_.key;
  warm_.lambda = solution_.lambda;
  for (int b = 0; b < hand_bodies; ++b)
    twist_[static_cast<std::size_t>(b)] = solution_.z.segment<6>(6 * b) * options_.dt * options_.dt;
  return true;
}

void HandDrag::sub_step(double share, DragFrame& frame) {
  // Parts that move to and fro do so at their own pace; a share of the frame's motion is left of a sub-step on.
  const double phase = std::cos(2 * pi * static_cast<double>(frame_) * options_.dt);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const std::size_t body = hand_bodies + p;
    twist_[body] = share * options_.dt * phase * parts_[p].velocity;
    scene_.bodies[body].prescribed = twist_[body] / (options_.dt * options_.dt);
  }
  const double asked = limited_coupling();
  z_u_ *= share;

  double start = thread_cpu_seconds();
  touches_ = world_.touches(std::max(options_.activation, 2 * asked * share));
  frame.touches += thread_cpu_seconds() - start;
  start = thread_cpu_seconds();
  manifold_.reduce(touches_, !options_.reduce);
  frame.manifold += thread_cpu_seconds() - start;
  if (frame.raw == 0) {
    frame.raw = static_cast<int>(touches_.size());
    frame.kept = static_cast<int>(manifold_.kept().size());
  }

  bool solved = solve();
  std::array<Vec<double, 6>, hand_bodies> first;
  std::copy_n(twist_.begin(), hand_bodies, first.begin());
  for (int round = 0; round < 8 && solved && options_.lazy; ++round) {
    start = thread_cpu_seconds();
    const int added = manifold_.complete(touches_, world_, twist_, 0.5 * options_.gap, 0.1 * options_.gap);
    frame.manifold += thread_cpu_seconds() - start;
    if (added == 0) break;
    frame.completed += added;
    solved = solve();
  }
  for (int b = 0; b < hand_bodies && solved; ++b)
    frame.change = std::max(
        frame.change, (twist_[static_cast<std::size_t>(b)] - first[static_cast<std::size_t>(b)]).head<3>().norm());
  if (!solved)
    for (int b = 0; b < hand_bodies; ++b) twist_[static_cast<std::size_t>(b)].setZero();

  moves_.clear();
  for (int c = 0; c < world_.size(); ++c)
    if (const auto& t = twist_[static_cast<std::size_t>(c)]; !t.isZero(0)) moves_.push_back({c, t});
  start = thread_cpu_seconds();
  const collision::TimeOfContact toc = world_.time_of_contact(moves_);
  frame.toc += thread_cpu_seconds() - start;
  frame.overlap = frame.overlap || toc.overlap;
  frame.truncations += toc.time < 1;
  toc_ = toc.time;
  if (watch) watch(moves_, toc.time);
  start = thread_cpu_seconds();
  for (const collision::Move& move : moves_) {
    const Pose<double> to = retract(world_.pose(move.collider), Vec<double, 6>(toc.time * move.twist));
    world_.place(move.collider, to);
    scene_.bodies[static_cast<std::size_t>(move.collider)].pose = to;
  }
  frame.toc += thread_cpu_seconds() - start;
}

DragFrame HandDrag::step() {
  DragFrame frame;
  aim();
  double share = 1;
  for (int k = 0; k < options_.sub_steps && share > 1e-3; ++k) {
    sub_step(share, frame);
    share *= 1 - toc_;
  }
  frame.held = share > 1e-3;
  ++frame_;
  std::array<bool, hand_bodies> touches{};
  for (const collision::Touch& t : world_.touches(5e-4)) {
    frame.gap = std::min(frame.gap, t.gap);
    if (t.b >= hand_bodies) touches[static_cast<std::size_t>(t.a)] = true;
  }
  frame.touching = static_cast<int>(std::count(touches.begin(), touches.end(), true));
  return frame;
}

}  // namespace zwang
