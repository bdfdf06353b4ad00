#include <algorithm>
#include <cmath>
#include <numbers>

#include <zwang/bench/collision/drag.h>
#include <zwang/bench/scenes/physical.h>

// Where the target of a dragged hand is.

namespace zwang {
namespace {

using std::numbers::pi;

const double palm_half = hand::standard().palm_widths.z() / 2;  // m

}  // namespace

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
    ground_.place(static_cast<int>(p), world_.pose(hand::bodies + static_cast<int>(p)));
  const int palm = ground_.size() - 1;
  const double top = high_.z() + above;
  ground_.place(palm, {{at.x(), at.y(), top}, axes});
  collision::Move down{palm};
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

}  // namespace zwang
