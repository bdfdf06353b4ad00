#pragma once

#include <functional>

#include <zwang/experiments/god_hand/motion/hand_motion.h>

namespace zwang::god {

// Fingers bent alike, by a share of these angles [degrees]; the thumb's second, sideways, is always there in full.
struct Posture {
  double base, middle, tip;
  std::array<double, 4> thumb;

  hand::Angles at(double share) const;
};

// A hand's track made of places and when they are reached [s]; between them a screw, and angles that grow evenly.
class Keyframes {
 public:
  enum class Way { eased, even, jump };  // to a stop, at constant speed, at once

  Keyframes(const hand::Model& model, const Pose<double>& palm, const hand::Angles& angles);

  Keyframes& to(double time, const Pose<double>& palm, const hand::Angles& angles, Way way = Way::eased);
  Keyframes& to(double time, const Pose<double>& palm, Way way = Way::eased);
  Keyframes& stay(double time);

  // Changes the keys of [from, to) as a faulty tracker would; append() takes them again.
  Keyframes& spoil(double from, double to, const std::function<void(Target&)>& how);

  Pose<double> start() const { return track_.keys.front().target.palm; }
  const Track& track() const { return track_; }

 private:
  Track track_;
};

}  // namespace zwang::god
