#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <zwang/constraints/revolute_joint.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/experiments/god_hand/tools/tool.h>
#include "tests/folders.h"
#include "tests/god_hand/tracked.h"

namespace zwang::god {

// A file of this text, while it is there.
struct Written {
  std::filesystem::path path;
  Written(const std::string& text, const std::string& kind) : path(own_path("tool" + kind)) {
    std::ofstream(path) << text;
  }
  ~Written() { std::filesystem::remove(path); }
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return std::move(text).str();
}

inline Tool tool_of(const std::string& text, const std::string& kind) {
  return make_tool(Written(text, kind).path.string());
}

// What is said of it, without the file's name; "" where it is read.
inline std::string refusal(const std::string& text, const std::string& kind) {
  const Written file(text, kind);
  try {
    make_tool(file.path.string());
  } catch (const BadFile& bad) {
    const std::string line = bad.what(), name = file.path.string();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_TRUE(line.starts_with(name)) << line;
    return line.substr(name.size());
  }
  return "";
}

// The tool's closing at this angle [rad].
inline Target closed(double angle, const Pose<double>& palm = {}) {
  Target target{.palm = palm};
  target.angles[Tool::closing] = angle;
  return target;
}

// The angle of a hinge of the tool among poses of its bodies [rad]: by how much the body that it turns has turned
// against the one that it hangs on, about the hinge's axis.
inline double angle_of(const Tool& tool, const std::string& hinge, std::span<const Pose<double>> poses) {
  Scene scene = tool.objects.scene;
  for (const Tool::Drive& drive : tool.drives) {
    if (drive.name != hinge) continue;
    for (const RevoluteJoint& joint : scene.list_of<RevoluteJoint>().all) {
      const auto on = static_cast<std::size_t>(joint.bodies[0]), part = static_cast<std::size_t>(joint.bodies[1]);
      const Vec3 anchor = scene.bodies[on].pose * joint.anchor_a;
      const Vec3 axis = scene.bodies[on].pose.turn(joint.axis_a);
      if ((anchor - drive.at).norm() > 1e-9 || (axis - drive.axis).norm() > 1e-9) continue;
      if (std::ranges::find(drive.behind, joint.bodies[1]) == drive.behind.end()) continue;
      const Mat3 rest = scene.bodies[on].pose.rotation.transpose() * scene.bodies[part].pose.rotation;
      const Mat3 now = poses[on].rotation.transpose() * poses[part].rotation;
      const Mat3 turn = now * rest.transpose();
      const Vec3 across = joint.axis_a.unitOrthogonal();
      return std::atan2(joint.axis_a.dot(across.cross(turn * across)), across.dot(turn * across));
    }
  }
  ADD_FAILURE() << "no hinge " << hinge;
  return 0;
}

struct Kept {
  double gap = 1, joints = 0, limits = 0;
  void add(const Frame& f) {
    gap = std::min(gap, f.gap);
    joints = std::max(joints, f.separation);
    limits = std::max(limits, f.limit);
  }
};

}  // namespace zwang::god
