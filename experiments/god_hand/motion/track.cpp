#include <algorithm>
#include <cmath>

#include <zwang/experiments/god_hand/motion/hand_motion.h>

namespace zwang::god {

Target part_of_way(const Target& from, const Target& to, double share) {
  Target out = from;
  out.palm = retract(from.palm, Vec<double, 6>(share * twist_between(from.palm, to.palm)));
  for (std::size_t k = 0; k < out.angles.size(); ++k) out.angles[k] += share * (to.angles[k] - from.angles[k]);
  for (std::size_t k = 0; k < out.hinges.size(); ++k) out.hinges[k] += share * (to.hinges[k] - from.hinges[k]);
  return out;
}

Target Track::at(double time) const {
  if (keys.empty()) return {.tracked = false};
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Key& k) { return t < k.time; });
  const Key& before = next == keys.begin() ? *next : *(next - 1);
  if (time == before.time) return before.target;
  const bool joined = next != keys.begin() && next != keys.end() && before.target.tracked && next->target.tracked &&
                      next->time - before.time <= patience;
  if (joined) return part_of_way(before.target, next->target, (time - before.time) / (next->time - before.time));
  Target held = before.target;
  held.tracked = false;
  return held;
}

void append(Track& track, Track::Key key) {
  const Pose<double>& palm = key.target.palm;
  constexpr double farthest = 1000;  // m from the origin: no tracker sees farther, and searches must end
  const bool finite = palm.position.norm() <= farthest && palm.rotation.allFinite() &&
                      std::ranges::all_of(key.target.angles, [](double angle) { return std::isfinite(angle); });
  if (!finite || !key.target.tracked) {
    ++track.held_over;
    if (track.keys.empty()) return;
    key.target = track.keys.back().target;
    key.target.tracked = false;
  }
  track.keys.push_back(std::move(key));
}

}  // namespace zwang::god
