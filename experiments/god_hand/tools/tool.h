#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <zwang/experiments/god_hand/simulation.h>

namespace zwang::god {

// God objects other than a hand (sections 3 and 4 of the paper): the first body follows where the palm of a motion is,
// the others go with it as they are joined. A tool points along y, as fingers do, its back is toward z.
struct Tool {
  static constexpr int closing = 4;  // of hand::Angles: the index finger's base, which every grasp bends

  // A hinge's target: what is behind it turns about an axis by so much of the motion's closing angle, or as a path
  // says.
  struct Drive {
    std::string name;                     // of the hinge
    double scale;                         // rad per rad
    Vec3 axis, at;                        // unit, m; at rest, in the palm's axes
    std::vector<BodyId> behind;           // all that turn with it
    double rest = 0;                      // rad: what a path calls the angle at rest
    double least = -1e300, most = 1e300;  // rad from rest; beyond these the other bound of its range would be nearer
  };

  std::string name = {};
  GodObjects objects = {};         // at rest, about the palm
  std::vector<Drive> drives = {};  // a hinge behind another one comes before it

  std::vector<Pose<double>> poses(const Target& at) const;
};

// One with a name (tools()); mesh files "a.stl@mm,b.obj": the convex hull of each (of the 64 outermost of its vertices,
// rounded by 0.5 mm), joined rigidly; a mechanism (mechanism.h). Throws std::invalid_argument with the nearest name,
// BadFile for a file.
Tool make_tool(const std::string& name);
std::vector<std::pair<std::string, std::string>> tools();  // name, one line

// The path of a tool from a table: time,x,y,z,qw,qx,qy,qz; perhaps close [rad], the angle that closes a gripper; and
// columns with the names of hinges [rad], which set these. None: the file is not such a table. Throws BadFile.
std::optional<HandMotion> read_path(const std::filesystem::path& file, const Tool& tool);

}  // namespace zwang::god
