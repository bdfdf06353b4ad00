#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <zwang/bench/scenes/physical.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/motion/recording.h>
#include <zwang/experiments/god_hand/scenes/depth.h>

namespace zwang::god {
namespace {

constexpr double approach = 0.5;          // s
constexpr double deep = 0.012;            // m, at some time
constexpr double start_clearance = 0.01;  // m, at the start

// The fixed objects: a loose one is pushed away before a hand is inside it. All objects where none is fixed.
Surroundings staying(Surroundings about) {
  const auto loose = [](const Object& o) { return o.loose(); };
  if (!std::all_of(about.objects.begin(), about.objects.end(), loose)) std::erase_if(about.objects, loose);
  return about;
}

// The poses of all hands at one time.
using Moment = std::vector<hand::Poses>;

std::vector<Moment> moments(const HandMotion& motion, double step) {
  std::vector<Moment> out;
  const int count = std::max(2, static_cast<int>(motion.duration / step));
  for (int k = 0; k <= count; ++k) {
    out.emplace_back();
    for (const Track& track : motion.hands) {
      const Target at = track.at(motion.duration * k / count);
      out.back().push_back(hand::forward_kinematics(at.palm, at.angles, track.model));
    }
  }
  return out;
}

class Finder {
 public:
  Finder(const HandMotion& motion, const Surroundings& about, const Depth& depth)
      : depth_(depth), focus_(about.focus), moments_(moments(motion, std::max(0.02, motion.duration / 100))) {
    for (const Track& track : motion.hands) balls_.push_back(balls(track.model));
    for (const Moment& m : moments_) {
      Vec3 middle = Vec3::Zero();
      for (const hand::Poses& hand : m)
        for (const Pose<double>& pose : hand) middle += pose.position / static_cast<double>(16 * m.size());
      middles_.push_back(middle);
    }
    // Some moments may be a tracker's error, hundreds of metres away, and the search goes from the highest to the
    // lowest.
    const Usual usual = usual_place(middles_);
    const double far = std::max(5.0, 3 * usual.distance);
    std::erase_if(middles_, [&](const Vec3& p) { return (p - usual.place).norm() > far; });
  }

  Placement evaluate(const Pose<double>& by) const {
    Placement out;
    for (const Moment& m : moments_) {
      double deepest = -1e-9;
      for (std::size_t h = 0; h < m.size(); ++h) {
        hand::Poses moved = m[h];
        for (Pose<double>& pose : moved) pose = placed(by, pose);
        deepest = std::max(deepest, depth_.of(moved, balls_[h]));
      }
      out.inside += deepest > 0 ? 1.0 / static_cast<double>(moments_.size()) : 0;
      out.depth = std::max(out.depth, deepest);
    }
    return out;
  }

  // Turned about z, its middle of the lowest `part` of the moments over the focus; lowered in steps to the first height
  // at which it is as asked, and back up to where it just is. None where no height is.
  std::optional<Pose<double>> lowered(double turn, double part, double share, double depth) const {
    Pose<double> by{Vec3::Zero(), rotation(turn * Vec3::UnitZ())};
    std::vector<Vec3> low = middles_;
    std::sort(low.begin(), low.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
    const double top = low.back().z(), bottom = low.front().z();
    low.resize(std::max<std::size_t>(1, static_cast<std::size_t>(part * static_cast<double>(low.size()))));
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : low) middle += p / static_cast<double>(low.size());
    by.position.head<2>() = (focus_ - by.rotation * middle).head<2>();
    const auto at = [&](double lowest) {
      Pose<double> out = by;
      out.position.z() = focus_.z() + lowest - bottom;
      return out;
    };
    const auto good = [&](double lowest) {
      const Placement seen = evaluate(at(lowest));
      return seen.inside >= share && seen.depth >= depth;
    };
    constexpr double step = 0.01;
    double lowest = 0.1;
    while (!good(lowest)) {
      lowest -= step;
      if (lowest < -0.05 - (top - bottom)) return std::nullopt;
    }
    double above = lowest + step;
    for (int k = 0; k < 3; ++k) {
      const double half = (above + lowest) / 2;
      (good(half) ? lowest : above) = half;
    }
    return at(lowest);
  }

 private:
  const Depth& depth_;
  Vec3 focus_;
  std::vector<Moment> moments_;
  std::vector<Vec3> middles_;
  std::vector<std::vector<Ball>> balls_;
};

// A hand that would begin in touch comes down on its first pose from above instead, in half a second; the others wait.
void clear_start(HandMotion& motion, const Depth& depth) {
  double later = 0, highest = 0;
  std::vector<double> raise;
  for (const Track& track : motion.hands) {
    Target at = track.keys.front().target;
    const double before = at.palm.position.z();
    const std::vector<Ball> of_hand = balls(track.model);
    const auto clear = [&] {
      const hand::Poses poses = hand::forward_kinematics(at.palm, at.angles, track.model);
      return depth.of(poses, of_hand, start_clearance) <= -start_clearance;
    };
    while (!clear() && at.palm.position.z() < before + 1) at.palm.position.z() += 0.01;
    raise.push_back(at.palm.position.z() - before);
    highest = std::max(highest, raise.back());
    if (raise.back() > 0) later = std::max(later, approach - track.keys.front().time);
  }
  if (highest == 0) return;
  for (std::size_t h = 0; h < motion.hands.size(); ++h) {
    std::vector<Track::Key>& keys = motion.hands[h].keys;
    for (Track::Key& key : keys) key.time += later;
    const Track::Key first = keys.front();
    const double from = raise[h] > 0 ? first.time - approach : 0;
    std::vector<Track::Key> before;
    constexpr int count = 25;
    for (int k = 0; k < count && first.time > from; ++k) {
      const double u = static_cast<double>(k) / count;
      before.push_back({from + u * (first.time - from), first.target});
      before.back().target.palm.position.z() += raise[h] * (1 - u * u * (3 - 2 * u));
    }
    keys.insert(keys.begin(), before.begin(), before.end());
  }
  motion.duration += later;
  motion.notes.push_back("begins with 0.5 s of coming down " + std::to_string(std::lround(100 * highest)) +
                         " cm: its first pose is not clear of the objects");
}

}  // namespace

Placement place(HandMotion& motion, const Surroundings& about, double share) {
  const Depth solid(about), firm(staying(about));
  const Finder finder(motion, about, firm);
  const double needed = std::min(0.95, share * (motion.duration + approach) / motion.duration);
  std::optional<Pose<double>> by;
  for (const double part : {1.0, 0.3})
    for (int turn = 0; turn < 4 && !by; ++turn) by = finder.lowered(turn * std::numbers::pi / 2, part, needed, deep);
  if (!by)
    motion.notes.push_back(
        printed("at no height is a hand in an object for %.0f%% of the time and %.0f mm deep: placed without that",
                100 * share, 1e3 * deep));
  if (!by) by = finder.lowered(0, 1, 0, deep);
  if (!by) by = finder.lowered(0, 1, 0, 0);
  for (Track& track : motion.hands)
    for (Track::Key& key : track.keys) key.target.palm = placed(*by, key.target.palm);
  clear_start(motion, solid);
  return Finder(motion, about, firm).evaluate({});
}

}  // namespace zwang::god
