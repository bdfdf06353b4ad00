#pragma once

#include <filesystem>
#include <optional>

#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// The path of a tool from a table: time,x,y,z,qw,qx,qy,qz; perhaps close [rad], the angle that closes a gripper; and
// columns with the names of hinges [rad], which set these. None: the file is not such a table. Throws BadFile.
std::optional<HandMotion> read_path(const std::filesystem::path& file, const Tool& tool);

// A simulation of a tool that follows a motion, from where it is first tracked.
class ToolPlay {
 public:
  ToolPlay(const Surroundings& surroundings, const HandMotion& motion, const Tool& tool, const Options& options);
  const Frame& step(long number);  // as Play::step
  Simulation& simulation() { return simulation_; }

 private:
  const HandMotion& motion_;
  const Tool& tool_;
  double dt_;
  Simulation simulation_;
};

}  // namespace zwang::god
