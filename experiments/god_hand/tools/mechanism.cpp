#include <zwang/experiments/god_hand/tools/mechanism.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/hand/hand_shapes.h>
#include <zwang/experiments/god_hand/hand/skeleton.h>

namespace zwang::god {
namespace {

bool is_scene(const std::filesystem::path& file) { return file.extension() == ".json"; }

bool is_model(const std::filesystem::path& file) {
  std::string kind = file.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kind == ".xml" || kind == ".mjcf" || kind == ".urdf";
}

// "@x-z": the axes of a file that are the palm's y and z. Rows: the palm's axes in the file.
Mat3 palm_axes(const std::string& name, const std::string& text) {
  std::vector<Vec3> axes;
  double sign = 1;
  bool sound = true;
  for (const char c : text.substr(1)) {
    const bool axis = c >= 'x' && c <= 'z';
    if (axis) axes.push_back(sign * Vec3::Unit(c - 'x'));
    sound = sound && (axis || c == '+' || c == '-');
    sign = c == '-' ? -1 : 1;
  }
  if (!sound || axes.size() != 2 || axes[0].dot(axes[1]) != 0)
    throw std::invalid_argument("--god " + name + ": '" + text +
                                "' should name the two axes of the file that go along the fingers and out of the back "
                                "of the hand, as @x-z does");
  return (Mat3() << axes[0].cross(axes[1]).transpose(), axes[0].transpose(), axes[1].transpose()).finished();
}

// The tree of a tool's bodies.
struct BodyTree {
  explicit BodyTree(Scene& scene) : parent(scene.bodies.size(), -1), welded(scene.bodies.size()) {
    each_joint_list(scene, [this]<class J>(const ConstraintListOf<J>& list) {
      for (const J& joint : list.all) {
        parent[at(joint.bodies[1])] = joint.bodies[0];
        welded[at(joint.bodies[1])] = std::is_same_v<J, Weld>;
      }
    });
  }

  BodyId up(BodyId b) const { return parent[at(b)]; }
  bool is_behind(BodyId b, BodyId root) const {
    while (b != root && b >= 0) b = up(b);
    return b == root;
  }
  int depth(BodyId b) const { return b < 0 ? 0 : 1 + depth(up(b)); }
  // The first body of those that are welded together with this one.
  BodyId piece(BodyId b) const { return welded[at(b)] ? piece(up(b)) : b; }
  // Parts of one rigid piece, or of two that a joint holds together.
  bool joined(BodyId a, BodyId b) const {
    const auto pieces = [this](BodyId one, BodyId other) { return std::minmax({piece(one), piece(other)}); };
    if (piece(a) == piece(b)) return true;
    for (BodyId c = 0; c < static_cast<BodyId>(parent.size()); ++c)
      if (up(c) >= 0 && pieces(c, up(c)) == pieces(a, b)) return true;
    return false;
  }

  std::vector<BodyId> parent;
  std::vector<bool> welded;  // to the parent
};

void pass_at_rest(Tool& tool, const BodyTree& tree) {
  GodObjects& objects = tool.objects;
  const auto count = static_cast<BodyId>(objects.shapes.size());
  collision::World world;
  for (std::size_t b = 0; b < objects.shapes.size(); ++b) world.add(objects.shapes[b], objects.scene.bodies[b].pose);
  for (const collision::Touch& touch : world.touches(hand::touching)) objects.pass(touch.a, touch.b);
  for (BodyId a = 0; a < count; ++a)
    for (BodyId b = a + 1; b < count; ++b)
      if (tree.joined(a, b)) objects.pass(a, b);
}

Tool::Drive drive_of(Scene& scene, const BodyTree& tree, const HingeDrive& hinge) {
  const auto& joints = scene.list_of<RevoluteJoint>().all;
  const RevoluteJoint& joint =
      *std::ranges::find_if(joints, [&](const RevoluteJoint& j) { return j.bodies[1] == hinge.body; });
  const Pose<double>& on = scene.bodies[at(joint.bodies[0])].pose;
  Tool::Drive drive{.name = hinge.name,
                    .scale = hinge.scale,
                    .axis = on.turn(joint.axis_a),
                    .at = on * joint.anchor_a,
                    .behind = {},
                    .rest = hinge.rest};
  for (BodyId b = 0; b < static_cast<BodyId>(scene.bodies.size()); ++b)
    if (tree.is_behind(b, hinge.body)) drive.behind.push_back(b);
  for (const JointLimit& limit : scene.list_of<JointLimit>().all) {
    if (std::minmax(limit.bodies[0], limit.bodies[1]) != std::minmax(joint.bodies[0], joint.bodies[1])) continue;
    const double room = std::min(limit.farthest, 3.14) - 1e-3;  // rad
    const bool both = limit.farthest < JointLimit::half_turn, low = limit.side == Side::lower;
    if (low || !both) drive.least = limit.bound - room;
    if (!low || !both) drive.most = limit.bound + room;
  }
  return drive;
}

}  // namespace

void complete(Tool& tool, const std::vector<HingeDrive>& hinges) {
  Scene& scene = tool.objects.scene;
  std::vector<Pose<double>> poses = mapped(scene.bodies, &Body::pose);
  Skeleton(scene).close(poses, false);
  for (std::size_t b = 0; b < poses.size(); ++b) scene.bodies[b].pose = poses[b];
  const BodyTree tree(scene);
  std::vector<HingeDrive> outermost_first = hinges;
  std::ranges::stable_sort(outermost_first, [&](const HingeDrive& a, const HingeDrive& b) {
    return tree.depth(a.body) > tree.depth(b.body);
  });
  for (const HingeDrive& hinge : outermost_first) tool.drives.push_back(drive_of(scene, tree, hinge));
  pass_at_rest(tool, tree);
}

std::array<std::string, 2> parts_of_name(const std::string& name) {
  const std::size_t at = name.rfind('@');
  if (at == std::string::npos) return {name, ""};
  return {name.substr(0, at), name.substr(at)};
}

bool is_mechanism(const std::string& name) {
  const std::filesystem::path file = parts_of_name(name)[0];
  return is_scene(file) || is_model(file);
}

Tool read_mechanism(const std::string& name) {
  const auto [file, axes] = parts_of_name(name);
  const std::optional<Mat3> turn = axes.empty() ? std::nullopt : std::optional(palm_axes(name, axes));
  Tool tool = is_scene(file) ? of_scene_file(file) : of_model(file);
  tool.name = std::filesystem::path(file).stem().string();
  if (!turn) return tool;
  for (Body& body : tool.objects.scene.bodies) body.pose = {*turn * body.pose.position, *turn * body.pose.rotation};
  for (Tool::Drive& drive : tool.drives) drive.axis = *turn * drive.axis, drive.at = *turn * drive.at;
  return tool;
}

}  // namespace zwang::god
