#pragma once

#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// A simulation of hands that follow a motion, or of a tool that follows its only hand. They start where each is first
// seen.
class Play {
 public:
  // Throws as Simulation does, and std::invalid_argument for a hand that is never tracked, or for a tool and two hands.
  // Motion and tool outlive it.
  Play(const Surroundings& surroundings, const HandMotion& motion, const Options& options, const Tool* tool = nullptr);

  // One step, toward where the motion is after `number` steps. Valid until the next call.
  const Frame& step(long number);
  Simulation& simulation() { return simulation_; }

 private:
  const HandMotion& motion_;
  const Tool* tool_;
  double dt_;  // s
  std::vector<Target> targets_;
  Simulation simulation_;
};

std::vector<hand::Model> models_of(const HandMotion& motion);

}  // namespace zwang::god
