#include <zwang/bench/collision/drag.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <zwang/bench/collision/hand_shapes.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/core/problem/cpu_clock.h>
#include <zwang/constraints/contact.h>
#include <zwang/core/problem/mix_bits.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

using collision::Filter;
using collision::Shape;
using std::numbers::pi;

constexpr int hand_bodies = hand::bodies;
constexpr std::uint64_t parts_bit = std::uint64_t{1} << 63;

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
        mix_bits(mix_bits(static_cast<std::uint64_t>(t.a) << 32 | static_cast<std::uint64_t>(t.b)) ^ t.feature);
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
