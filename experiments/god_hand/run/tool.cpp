#include <zwang/experiments/god_hand/run/tool.h>

#include <algorithm>
#include <cmath>

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/experiments/god_hand/motion/joint_table.h>
#include <zwang/experiments/god_hand/scenes/scene_parts.h>

namespace zwang::god {
namespace {

using collision::Shape;

constexpr int closing = 4;  // of hand::Angles: the index finger's base, which every grasp bends

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
    tool.drives.push_back({jaw, closing, 0.4 * side, Vec3::UnitZ(), hinge});
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

// The vertices that lie outermost in some direction, 64 at most, about their middle.
std::vector<Vec3> outermost(const collision::Tree& mesh, Vec3& middle) {
  middle = (mesh.low() + mesh.high()) / 2;
  std::vector<Vec3> points;
  for (int k = 0; k < 64; ++k) {
    const double z = 1 - (2 * k + 1) / 64., turn = 2.399963229728653 * k, r = std::sqrt(1 - z * z);
    const Vec3 way(r * std::cos(turn), r * std::sin(turn), z);
    Vec3 best = middle;
    double most = -1;
    for (const collision::Triangle& triangle : mesh.triangles())
      for (const Vec3& corner : triangle.corner)
        if (const double far = way.dot(corner - middle); far > most) most = far, best = corner;
    const Vec3 point = best - middle;
    if (std::ranges::none_of(points, [&](const Vec3& p) { return p == point; })) points.push_back(point);
  }
  return points;
}

Tool of_meshes(const std::string& files) {
  Tool tool;
  Vec3 root = Vec3::Zero();
  for (const Object& object : files_scene(files).objects) {
    Vec3 middle;
    const std::vector<Vec3> points = outermost(*object.mesh, middle);
    const Vec3 widths = (object.mesh->high() - object.mesh->low()).cwiseMax(1e-3);
    const Shape hull = Shape::hull(points, 5e-4);
    const double mass = std::max(1e-3, 1000 * widths.prod());  // kg: water
    if (tool.objects.shapes.empty()) {
      root = middle;
      add(tool, hull, widths, mass, {});
    } else {
      weld(tool, hull, widths, mass, {middle - root, Mat3::Identity()});
    }
  }
  return tool;
}

}  // namespace

std::vector<Pose<double>> Tool::poses(const Target& target) const {
  std::vector<Pose<double>> out;
  for (const Body& body : objects.scene.bodies) out.push_back(placed(target.palm, body.pose));
  for (const Drive& d : drives) {
    Pose<double> rest = objects.scene.bodies[static_cast<std::size_t>(d.body)].pose;
    const Mat3 turn = rotation(d.scale * target.angles[static_cast<std::size_t>(d.angle)] * d.axis);
    rest = {d.at + turn * (rest.position - d.at), turn * rest.rotation};
    out[static_cast<std::size_t>(d.body)] = placed(target.palm, rest);
  }
  return out;
}

std::vector<std::pair<std::string, std::string>> tools() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Entry& e : entries) out.emplace_back(e.name, e.line);
  return out;
}

Tool make_tool(const std::string& name) {
  std::vector<std::string> names = {"hand"};
  for (const Entry& e : entries) {
    names.emplace_back(e.name);
    if (name != e.name) continue;
    Tool tool = e.make();
    tool.name = name;
    return tool;
  }
  if (name.find_first_of(".,@/") == std::string::npos)
    throw std::invalid_argument("no god object '" + name + "'" + did_you_mean(name, names));
  Tool tool = of_meshes(name);
  tool.name = name;
  return tool;
}

std::optional<HandMotion> read_path(const std::filesystem::path& file) {
  const StoredFile stored = read_stored(file);
  if (stored.kind() != ".csv") return std::nullopt;
  const JointTable table = parse_table(file, unpacked(stored, std::size_t{1} << 30));
  if (!table.has("qw")) return std::nullopt;
  const std::vector<std::string> names = {"time", "x", "y", "z", "qw", "qx", "qy", "qz", "close"};
  table.only(names);
  std::array<std::size_t, 8> column;
  for (std::size_t k = 0; k < column.size(); ++k) column[k] = table.column(names[k]);
  HandMotion motion{.name = file.stem().string(), .hands = {Track{.model = hand::standard()}}};
  double last = -1e300, begin = 0;
  for (const JointTable::Row& row : table.rows) {
    const auto value = [&](std::size_t k) { return row.values[column[k]]; };
    if (motion.hands[0].keys.empty()) begin = value(0);
    if (!std::isfinite(value(0)) || value(0) <= last)
      table.refuse("line " + std::to_string(row.line) + ": times that grow expected");
    last = value(0);
    Target target;
    const Eigen::Quaterniond q(value(4), value(5), value(6), value(7));
    target.palm = {{value(1), value(2), value(3)}, q.normalized().toRotationMatrix()};
    if (table.has("close")) target.angles[closing] = row.values[table.column("close")];
    target.tracked = target.palm.position.allFinite() && target.palm.rotation.allFinite() && q.norm() > 0.5 &&
                     std::isfinite(target.angles[closing]);
    append(motion.hands[0], {value(0) - begin, target});
  }
  if (motion.hands[0].keys.empty()) table.refuse("no line with a pose");
  motion.duration = motion.hands[0].keys.back().time;
  motion.hands[0].patience = std::max(motion.hands[0].patience, motion.duration);
  return motion;
}

static std::vector<GodObjects> started(Tool tool, const HandMotion& motion) {
  if (motion.hands.size() != 1) throw std::invalid_argument("a tool follows one hand, and the motion has two");
  const auto& keys = motion.hands[0].keys;
  const auto seen = std::ranges::find_if(keys, [](const Track::Key& key) { return key.target.tracked; });
  if (seen == keys.end()) throw std::invalid_argument("the motion has a pose at no time");
  const std::vector<Pose<double>> poses = tool.poses(seen->target);
  for (std::size_t b = 0; b < poses.size(); ++b) tool.objects.scene.bodies[b].pose = poses[b];
  std::vector<GodObjects> clusters;
  clusters.push_back(std::move(tool.objects));
  return clusters;
}

ToolPlay::ToolPlay(const Surroundings& surroundings, const HandMotion& motion, const Tool& tool, const Options& options)
    : motion_(motion), tool_(tool), dt_(options.dt), simulation_(surroundings, started(tool, motion), options) {}

const Frame& ToolPlay::step(long number) {
  return simulation_.step(tool_.poses(motion_.hands[0].at(static_cast<double>(number) * dt_)));
}

}  // namespace zwang::god
