#include <zwang/experiments/god_hand/motion/keyframes.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zwang::god {

using hand::Angles;
using Palm = Pose<double>;

constexpr double key_step = 0.005;  // s

Angles Posture::at(double share) const {
  constexpr double degree = std::numbers::pi / 180;
  Angles out = {};
  for (std::size_t k = 0; k < 4; ++k) out[k] = (k == 1 ? 1 : share) * thumb[k] * degree;
  for (std::size_t f = 1; f < 5; ++f) {
    out[4 * f] = share * base * degree;
    out[4 * f + 2] = share * middle * degree;
    out[4 * f + 3] = share * tip * degree;
  }
  return out;
}

Keyframes::Keyframes(const hand::Model& model, const Palm& palm, const Angles& angles) : track_{.model = model} {
  append(track_, {0, {palm, angles}});
}

Keyframes& Keyframes::to(double time, const Palm& palm, const Angles& angles, Way way) {
  const Track::Key from = track_.keys.back();
  const double whole = time - from.time;
  const int steps = way == Way::jump ? 1 : std::max(1, static_cast<int>(std::lround(whole / key_step)));
  if (way == Way::jump) stay(time - 1e-6);
  for (int k = 1; k <= steps; ++k) {
    const double u = static_cast<double>(k) / steps, s = way == Way::eased ? u * u * (3 - 2 * u) : u;
    const Target last{palm, angles};
    append(track_,
           {way == Way::jump ? time : from.time + u * whole, k < steps ? part_of_way(from.target, last, s) : last});
  }
  return *this;
}

Keyframes& Keyframes::to(double time, const Palm& palm, Way way) {
  return to(time, palm, Angles(track_.keys.back().target.angles), way);
}

Keyframes& Keyframes::stay(double time) { return to(time, Palm(track_.keys.back().target.palm), Way::even); }

Keyframes& Keyframes::spoil(double from, double to, const std::function<void(Target&)>& how) {
  Track out{.model = track_.model};
  for (Track::Key key : track_.keys) {
    if (key.time >= from && key.time < to) how(key.target);
    append(out, key);
  }
  track_ = std::move(out);
  return *this;
}

}  // namespace zwang::god
