#include <algorithm>

#include "experiments/god/motion.h"

namespace zwang::god {

Target Track::at(double time) const {
  if (keys.empty()) return {.tracked = false};
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, [](double t, const Key& k) { return t < k.time; });
  if (next == keys.begin()) {
    Target first = keys.front().target;
    first.tracked = first.tracked && time == keys.front().time;
    return first;
  }
  const Key& before = *(next - 1);
  if (time == before.time) return before.target;
  if (next == keys.end() || next->time - before.time > patience || !next->target.tracked) {
    Target held = before.target;
    held.tracked = held.tracked && time - before.time <= patience && next != keys.end();
    return held;
  }
  const double s = (time - before.time) / (next->time - before.time);
  Target between = before.target;
  between.palm = retract(between.palm, Vec<double, 6>(s * twist_between(between.palm, next->target.palm)));
  for (std::size_t k = 0; k < between.angles.size(); ++k)
    between.angles[k] += s * (next->target.angles[k] - before.target.angles[k]);
  return between;
}

}  // namespace zwang::god
