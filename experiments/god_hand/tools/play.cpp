#include <zwang/experiments/god_hand/tools/play.h>

#include <algorithm>
#include <stdexcept>

#include <zwang/constraints/joint_limit.h>

namespace zwang::god {
namespace {

std::vector<Target> first_targets(const HandMotion& motion) {
  std::vector<Target> targets;
  for (const Track& track : motion.hands) {
    const auto seen = std::ranges::find_if(track.keys, [](const Track::Key& key) { return key.target.tracked; });
    if (seen == track.keys.end()) throw std::invalid_argument("the motion has a hand that is never tracked");
    targets.push_back(seen->target);
  }
  return targets;
}

Simulation begun(const Surroundings& surroundings, const HandMotion& motion, const std::vector<Target>& at,
                 const Options& options, const Tool* tool) {
  if (tool == nullptr) return {surroundings, models_of(motion), at, options};
  if (at.size() != 1) throw std::invalid_argument("a tool follows one hand, and the motion has two");
  // Every hinge as the tool is made: there it does not touch itself.
  const auto easy = mapped(tool->objects.scene.bodies, [&](const Body& body) { return placed(at[0].palm, body.pose); });
  const std::vector<Pose<double>> poses = tool->poses(at[0]);
  std::vector<GodObjects> clusters = {tool->objects};
  Scene& scene = clusters[0].scene;
  for (std::size_t b = 0; b < poses.size(); ++b) scene.bodies[b].pose = poses[b];
  for (JointLimit& limit : scene.list_of<JointLimit>().all)
    limit.reach = options.limits == Options::Limits::predictive ? 0.25 : 0;  // rad, as of a hand
  return {surroundings, std::move(clusters), options, std::move(easy)};
}

}  // namespace

std::vector<hand::Model> models_of(const HandMotion& motion) { return mapped(motion.hands, &Track::model); }

Play::Play(const Surroundings& surroundings, const HandMotion& motion, const Options& options, const Tool* tool)
    : motion_(motion),
      tool_(tool),
      dt_(options.dt),
      targets_(first_targets(motion)),
      simulation_(begun(surroundings, motion, targets_, options, tool)) {}

const Frame& Play::step(long number) {
  for (std::size_t h = 0; h < targets_.size(); ++h)
    targets_[h] = motion_.hands[h].at(static_cast<double>(number) * dt_);
  return tool_ ? simulation_.step(tool_->poses(targets_[0])) : simulation_.step(targets_);
}

}  // namespace zwang::god
