#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <zwang/experiments/god_hand/hand/god_objects.h>
#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/frame.h>
#include <zwang/experiments/god_hand/step/options.h>

namespace zwang::god {

// The loop of section 6 of the paper (Fig. 6): physics, resolution of penetrations, god objects per cluster,
// integration up to the time of contact, coupling back.
class Simulation {
 public:
  // `models`: one per hand. Hands start at `start`; one that would touch something there comes down on it from above
  // everything, as far as it can. Throws std::runtime_error, one line, when there is no clear place for it, and
  // std::invalid_argument for a solver there is not.
  Simulation(Surroundings surroundings, std::span<const hand::Model> models, std::span<const Target> start,
             const Options& options);
  // The same for any god objects, starting where their scenes have them (sections 3 and 4); `easy`: where they do not
  // touch each other, should they do so there.
  Simulation(Surroundings surroundings, std::vector<GodObjects> clusters, const Options& options,
             std::vector<Pose<double>> easy = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // One step toward the targets, one per hand; of a hand that is not tracked, or whose target is not finite, the last
  // that was. Valid until the next call.
  const Frame& step(std::span<const Target> targets);
  // The same with a pose for every god object, cluster after cluster.
  const Frame& step(PoseSpan targets);

  // Called with every motion that is committed: number of the first god object that moves, and from where to where the
  // cluster does, each body along retract(from, s * twist_between(from, to)).
  using Watch = std::function<void(std::size_t first, PoseSpan from, PoseSpan to)>;
  void watch(Watch watch);

  PoseSpan object_poses() const;                      // of the surroundings, now
  const Problem& problem(std::size_t cluster) const;  // of its last solve
  // The shapes of the god objects, in the order of Frame::god.
  std::vector<collision::Shape> shapes() const;

  // The whole state between frames as numbers that restore() takes back: a run that is stopped and resumed at a
  // checkpoint gives the same bits as one that passes through it. Caches (warm starts, the engine's manifolds) are
  // dropped at both. restore() throws std::runtime_error for the state of another simulation.
  std::vector<double> checkpoint();
  void restore(std::span<const double> checkpoint);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace zwang::god
