#pragma once

#include <zwang/experiments/god_hand/simulation.h>

namespace zwang::god {

// A simulation of hands that follow a motion. They start where each is first seen.
class Play {
 public:
  // Throws as Simulation does, and std::invalid_argument for a hand that is never tracked. The motion outlives it.
  Play(const Surroundings& surroundings, const HandMotion& motion, const Options& options);

  // One step, toward where the hands are `number` steps into the motion. Valid until the next call.
  const Frame& step(long number);
  Simulation& simulation() { return simulation_; }

 private:
  const HandMotion& motion_;
  double dt_;  // s
  std::vector<Target> targets_;
  Simulation simulation_;
};

std::vector<hand::Model> models_of(const HandMotion& motion);

}  // namespace zwang::god
