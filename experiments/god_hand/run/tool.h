#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/simulation.h>

namespace zwang::god {

// God objects other than a hand (sections 3 and 4 of the paper): the first body follows where the palm of a motion is,
// the others go with it as they are joined. A tool points along y, as fingers do.
struct Tool {
  // The body turns about an axis through a point, by so much of an angle of the motion.
  struct Drive {
    BodyId body;
    int angle;      // of hand::Angles
    double scale;   // rad
    Vec3 axis, at;  // unit, m; in the first body's axes
  };

  std::string name = {};
  GodObjects objects = {};  // at rest, the first body at the origin
  std::vector<Drive> drives = {};

  std::vector<Pose<double>> poses(const Target& at) const;
};

// sphere, peg, key, gripper; or mesh files "a.stl@mm,b.obj": the convex hull of each (of the 64 outermost of its
// vertices, rounded by 0.5 mm), joined rigidly. Throws std::invalid_argument with the nearest name, BadFile for a file.
Tool make_tool(const std::string& name);
std::vector<std::pair<std::string, std::string>> tools();  // name, one line

// The path of a tool from a table: time,x,y,z,qw,qx,qy,qz and perhaps close [rad], the angle that closes a gripper.
// None: the file is not such a table. Throws BadFile.
std::optional<HandMotion> read_path(const std::filesystem::path& file);

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
