#include "bench/collision/drag.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "bench/scenes/physical.h"
#include "constraints/contact.h"
#include "solvers/registry.h"

namespace zwang {
namespace {

using collision::Filter;
using collision::Shape;
using std::numbers::pi;

constexpr int hand_bodies = hand::bodies;
constexpr double palm_half = 0.014;  // m

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Shape shape_of(int body) {
  if (body == 0) return Shape::rounded_box({0.084, 0.096, 2 * palm_half}, 0.006);
  const hand::Phalanx p = hand::phalanx(body);
  return Shape::capsule(p.length, p.radius);
}

// Bodies that share a joint overlap there, and so do the roots of neighbouring fingers.
Filter filter_of(int body) {
  const auto bit = [](int b) { return std::uint64_t{1} << b; };
  Filter f{bit(body), ~std::uint64_t{0}};
  const bool root = body > 0 && (body - 1) % 3 == 0;
  for (int other = 0; other < hand_bodies; ++other) {
    const bool other_root = other > 0 && (other - 1) % 3 == 0;
    const bool same_finger = body > 0 && other > 0 && (body - 1) / 3 == (other - 1) / 3;
    if (same_finger || ((root || body == 0) && (other_root || other == 0))) f.mask &= ~bit(other);
  }
  return f;
}

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
  const Pose<double> above{{(low_.x() + high_.x()) / 2, (low_.y() + high_.y()) / 2, high_.z() + 0.06},
                           Mat3::Identity()};
  const hand::Poses poses = hand::assemble(above, straight);
  hand::add(scene_, poses);
  for (int b = 0; b < hand_bodies; ++b) {
    shapes_.push_back(shape_of(b));
    world_.add(shapes_.back(), poses[static_cast<std::size_t>(b)], filter_of(b));
  }
  for (const Part& part : parts_) {
    world_.add(part.tree, part.pose, {parts_bit, ~std::uint64_t{0}});
    Body body{.pose = part.pose, .motion = part.velocity.isZero(0) ? Motion::fixed : Motion::prescribed};
    scene_.add(body);
  }
  twist_.resize(scene_.bodies.size());
  for (Vec<double, 6>& t : twist_) t.setZero();
}

// Where the hand is tracked in this frame: on a Lissajous curve over the parts, fingers curling; or along a bar, closed
// about it deeper than it lets them, the thumb less: there every phalanx but the first ones is pressed on something,
// while on a flat surface a hand that lies on its palm touches with its finger tips at most.
void HandDrag::aim() {
  const double t = static_cast<double>(frame_) * options_.dt;
  const bool grips = options_.grip > 0;
  const Vec3 middle = (low_ + high_) / 2;
  Vec3 reach = (0.3 * (high_ - low_)).cwiseMax(Vec3::Constant(0.02));
  if (grips) reach.y() = 0;
  // Both terms pass through the middle; the mean speed is about options_.speed.
  const double omega = options_.speed / std::hypot(reach.x(), 0.7 * reach.y());
  const double lowered = std::min(1.0, t / 0.15);
  const double height = high_.z() + palm_half + 0.05 * (1 - lowered) - options_.depth * lowered;
  Vec3 at(middle.x() + reach.x() * std::sin(omega * t), middle.y() + reach.y() * std::sin(0.7 * omega * t), height);
  double turn = 0.4 * std::sin(0.3 * omega * t) + (options_.spin > 0 ? std::sin(options_.spin * frame_) : 0);
  if (grips) turn *= 0.25, at.y() -= 0.045;
  hand::Angles angles{};
  for (int k = 0; k < hand::angles; ++k) {
    const double wave = 0.5 - 0.5 * std::cos(2 * pi * (0.7 + 0.05 * k) * t);
    const double share = grips ? lowered * options_.grip * (0.9 + 0.1 * wave) * (k < 4 ? 0.3 : 1.0) : 0.25 * wave;
    angles[static_cast<std::size_t>(k)] = k % 4 == 1 ? 0 : share * hand::range(k).high;
  }
  const Mat3 axes = rotation(turn * Vec3::UnitZ()) * rotation(Vec3(grips ? -0.5 : 0.0, 0, 0));
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

  double start = cpu_seconds();
  touches_ = world_.touches(std::max(options_.activation, 2 * asked * share));
  frame.touches += cpu_seconds() - start;
  start = cpu_seconds();
  manifold_.reduce(touches_, !options_.reduce);
  frame.manifold += cpu_seconds() - start;
  if (frame.raw == 0) {
    frame.raw = static_cast<int>(touches_.size());
    frame.kept = static_cast<int>(manifold_.kept().size());
  }

  bool solved = solve();
  std::array<Vec<double, 6>, hand_bodies> first;
  std::copy_n(twist_.begin(), hand_bodies, first.begin());
  for (int round = 0; round < 8 && solved && options_.lazy; ++round) {
    start = cpu_seconds();
    const int added = manifold_.complete(touches_, world_, twist_, 0.5 * options_.gap, 0.1 * options_.gap);
    frame.manifold += cpu_seconds() - start;
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
  start = cpu_seconds();
  const collision::TimeOfContact toc = world_.time_of_contact(moves_);
  frame.toc += cpu_seconds() - start;
  frame.overlap = frame.overlap || toc.overlap;
  frame.truncations += toc.time < 1;
  toc_ = toc.time;
  if (watch) watch(moves_, toc.time);
  start = cpu_seconds();
  for (const collision::Move& move : moves_) {
    const Pose<double> to = retract(world_.pose(move.collider), Vec<double, 6>(toc.time * move.twist));
    world_.place(move.collider, to);
    scene_.bodies[static_cast<std::size_t>(move.collider)].pose = to;
  }
  frame.toc += cpu_seconds() - start;
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
