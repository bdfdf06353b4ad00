#include <zwang/experiments/god_hand/tools/tool.h>

#include <algorithm>
#include <cmath>

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/scenes/scene_objects.h>
#include <zwang/experiments/god_hand/tools/hull.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>

namespace zwang::god {
namespace {

using collision::Shape;

Pose<double> at(double x, double y, double z = 0) { return {{x, y, z}, Mat3::Identity()}; }

BodyId add(Tool& tool, const Shape& shape, const Vec3& widths, double mass, const Pose<double>& pose) {
  Body body = box_body(widths, mass, pose.position);
  body.pose = pose;
  const BodyId id = tool.objects.add(body, shape);
  for (BodyId other = 0; other < id; ++other) tool.objects.pass(other, id);
  return id;
}

// A part that moves with the first body.
void weld(Tool& tool, const Shape& shape, const Vec3& widths, double mass, const Pose<double>& pose) {
  const BodyId id = add(tool, shape, widths, mass, pose);
  tool.objects.scene.add(Weld{{0, id}, pose.position, Vec3::Zero(), pose.rotation});
}

Tool sphere() {
  Tool tool;
  add(tool, Shape::sphere(0.02), {0.04, 0.04, 0.04}, 0.1, {});
  return tool;
}

Tool peg() {
  Tool tool;
  add(tool, Shape::capsule(0.06, 0.01), {0.02, 0.08, 0.02}, 0.1, {});
  return tool;
}

// A shaft, a bit at its tip that stands out along x, a handle.
Tool key() {
  Tool tool;
  add(tool, Shape::capsule(0.05, 0.003), {0.006, 0.056, 0.006}, 0.02, {});
  weld(tool, Shape::rounded_box({0.012, 0.006, 0.005}, 5e-4), {0.012, 0.006, 0.005}, 0.005, at(0.0085, 0.023));
  weld(tool, Shape::rounded_box({0.02, 0.012, 0.006}, 2e-3), {0.02, 0.012, 0.006}, 0.01, at(0, -0.031));
  return tool;
}

// Two jaws on hinges, which the motion closes.
Tool gripper() {
  Tool tool;
  constexpr double half = 0.025, arm = 0.03;
  add(tool, Shape::rounded_box({0.07, 0.03, 0.03}, 3e-3), {0.07, 0.03, 0.03}, 0.2, {});
  for (const double side : {-1., 1.}) {
    const Vec3 hinge(side * half, 0.022, 0);
    const BodyId jaw = add(tool, Shape::capsule(2 * arm, 0.006), {0.012, 2 * arm + 0.012, 0.012}, 0.04,
                           at(hinge.x(), hinge.y() + arm));
    tool.objects.scene.add(RevoluteJoint{{0, jaw}, hinge, Vec3(0, -arm, 0), Vec3::UnitZ(), Vec3::UnitZ()});
    tool.drives.push_back({side < 0 ? "left" : "right", 0.4 * side, Vec3::UnitZ(), hinge, {jaw}});
  }
  tool.objects.filters[1].mask |= tool.objects.filters[2].group;
  tool.objects.filters[2].mask |= tool.objects.filters[1].group;
  return tool;
}

struct Entry {
  const char* name;
  const char* line;
  Tool (*make)();
};
constexpr Entry entries[] = {{"sphere", "a ball of 20 mm radius", sphere},
                             {"peg", "80 mm long, of 10 mm radius, round at its ends (scene hole)", peg},
                             {"key", "a shaft with a bit and a handle (scene lock)", key},
                             {"gripper", "two jaws on hinges", gripper}};

Tool of_meshes(const std::string& files) {
  Tool tool;
  Vec3 root = Vec3::Zero();
  for (const Object& object : files_scene(files).objects) {
    const Hull hull = hull_of(*object.mesh);
    const double mass = std::max(1e-3, 1000 * hull.widths.prod());  // kg: water
    if (tool.objects.shapes.empty()) {
      root = hull.middle;
      add(tool, hull.shape, hull.widths, mass, {});
    } else {
      weld(tool, hull.shape, hull.widths, mass, {hull.middle - root, Mat3::Identity()});
    }
  }
  return tool;
}

}  // namespace

std::vector<Pose<double>> Tool::poses(const Target& target) const {
  std::vector<Pose<double>> out = mapped(objects.scene.bodies, &Body::pose);
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Drive& drive = drives[d];
    double angle = drive.scale * target.angles[closing];
    if (d < target.hinges.size() && !std::isnan(target.hinges[d])) angle = target.hinges[d] - drive.rest;
    const Mat3 turn = rotation(std::clamp(angle, drive.least, drive.most) * drive.axis);
    for (const BodyId b : drive.behind) {
      Pose<double>& pose = out[static_cast<std::size_t>(b)];
      pose = {drive.at + turn * (pose.position - drive.at), turn * pose.rotation};
    }
  }
  for (Pose<double>& pose : out) pose = placed(target.palm, pose);
  return out;
}

std::vector<std::pair<std::string, std::string>> tools() {
  return mapped(entries, [](const Entry& e) { return std::pair<std::string, std::string>(e.name, e.line); });
}

Tool make_tool(const std::string& name) {
  const auto entry = std::ranges::find(entries, name, &Entry::name);
  if (entry == std::end(entries) && name.find_first_of(".,@/") == std::string::npos)
    throw std::invalid_argument("no god object '" + name + "'" + did_you_mean(name, names_of(entries, &Entry::name)) +
                                " (./zwang simulate --help lists all)");
  if (entry == std::end(entries) && is_mechanism(name)) return read_mechanism(name);
  Tool tool = entry != std::end(entries) ? entry->make() : of_meshes(name);
  tool.name = name;
  return tool;
}

}  // namespace zwang::god
