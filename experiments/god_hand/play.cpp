#include <zwang/experiments/god_hand/play.h>

#include <algorithm>
#include <stdexcept>

namespace zwang::god {

static std::vector<Target> first_targets(const HandMotion& motion) {
  std::vector<Target> targets;
  for (const Track& track : motion.hands) {
    const auto seen = std::ranges::find_if(track.keys, [](const Track::Key& key) { return key.target.tracked; });
    if (seen == track.keys.end()) throw std::invalid_argument("the motion has a hand that is never tracked");
    targets.push_back(seen->target);
  }
  return targets;
}

std::vector<hand::Model> models_of(const HandMotion& motion) {
  std::vector<hand::Model> models;
  for (const Track& track : motion.hands) models.push_back(track.model);
  return models;
}

Play::Play(const Surroundings& surroundings, const HandMotion& motion, const Options& options)
    : motion_(motion),
      dt_(options.dt),
      targets_(first_targets(motion)),
      simulation_(surroundings, models_of(motion), targets_, options) {}

const Frame& Play::step(long number) {
  for (std::size_t h = 0; h < targets_.size(); ++h)
    targets_[h] = motion_.hands[h].at(static_cast<double>(number) * dt_);
  return simulation_.step(targets_);
}

}  // namespace zwang::god
