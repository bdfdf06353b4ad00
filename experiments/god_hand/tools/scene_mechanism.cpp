#include <zwang/bench/scenes/scene_file.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/experiments/god_hand/tools/hull.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>

namespace zwang::god {
namespace {

using Joint = WrittenScene::Joint;

// The same joint, seen from its second body. A hinge's angle stays what it is.
template <class J>
J turned_round(J joint) {
  std::swap(joint.bodies[0], joint.bodies[1]);
  std::swap(joint.anchor_a, joint.anchor_b);
  if constexpr (requires { joint.axis_a; }) std::swap(joint.axis_a, joint.axis_b);
  if constexpr (std::is_same_v<J, RevoluteJoint>) joint.axis_a *= -1, joint.axis_b *= -1;
  if constexpr (std::is_same_v<J, Weld>) joint.relative.transposeInPlace();
  return joint;
}

class FromScene {
 public:
  explicit FromScene(const std::filesystem::path& file) : file_(read_written_scene(file)) {}

  Tool tool() {
    if (file_.parts.empty()) file_.root["bodies"].fail("a body among them");
    if (std::ssize(file_.parts) > GodObjects::most)
      file_.root["bodies"].fail("at most " + std::to_string(GodObjects::most) + " in a god object");
    for (std::size_t b = 0; b < file_.parts.size(); ++b) add_body(b);
    add_joints();
    complete(tool_, hinges_);
    return std::move(tool_);
  }

 private:
  // The first body comes to the origin, with the rotation that it has in the file.
  void add_body(std::size_t b) {
    const WrittenScene::Part& part = file_.parts[b];
    Body body = file_.scene.bodies[b];
    if (body.motion != zwang::Motion::free)
      part.written["motion"].fail("\"free\": what is moved as a god object has no other motion");
    if (!part.shape && !part.mesh) part.written.fail("a member 'shape': a god object meets things");
    body.pose.position -= file_.scene.bodies[0].pose.position;
    body.velocity.setZero();
    if (part.shape) {
      tool_.objects.add(body, *part.shape);
      return;
    }
    // The hull's middle need not be where the file has the centre of mass.
    const Hull hull = hull_of(*part.mesh);
    std::vector<Vec3> corners(hull.shape.corners().begin(), hull.shape.corners().end());
    for (Vec3& corner : corners) corner += hull.middle;
    tool_.objects.add(body, collision::Shape::hull(corners, hull.shape.radius()));
  }

  // From the first body outward.
  void add_joints() {
    std::vector<char> reached(file_.parts.size(), 0);
    reached[0] = 1;
    std::vector<char> done(file_.joints.size(), 0);
    for (bool more = true; more;) {
      more = false;
      for (std::size_t k = 0; k < done.size(); ++k) {
        const Joint& joint = file_.joints[k];
        if (joint.type == "slider" || joint.type == "distance" || joint.type == "rope")
          joint.written["type"].fail("ball, hinge, universal or weld in a god object");
        char &a = reached[at(joint.bodies[0])], &b = reached[at(joint.bodies[1])];
        if (done[k] || (!a && !b)) continue;
        if (a && b)
          joint.written.fail("no loop: '" + joint.name + "' joins bodies of a god object that are joined already");
        add(joint, !a);
        a = b = done[k] = 1;
        more = true;
      }
    }
    for (std::size_t b = 0; b < reached.size(); ++b)
      if (!reached[b]) file_.parts[b].written.fail("a body that joints connect with '" + file_.parts[0].name + "'");
    for (const JointLimit& limit : file_.scene.list_of<JointLimit>().all) tool_.objects.scene.add(limit);
  }

  void add(const Joint& joint, bool backward) {
    const auto put = [&]<class J>(const ConstraintListOf<J>& list) {
      const J& j = list.all[joint.item];
      tool_.objects.scene.add(backward ? turned_round(j) : j);
    };
    if (joint.type == "ball") put(file_.scene.list_of<BallJoint>());
    if (joint.type == "weld") put(file_.scene.list_of<Weld>());
    if (joint.type == "universal") put(file_.scene.list_of<UniversalJoint>());
    if (joint.type != "hinge") return;
    put(file_.scene.list_of<RevoluteJoint>());
    hinges_.push_back({joint.name, joint.bodies[backward ? 0 : 1], joint.drive});
  }

  WrittenScene file_;
  Tool tool_;
  std::vector<HingeDrive> hinges_;
};

}  // namespace

Tool of_scene_file(const std::filesystem::path& file) { return FromScene(file).tool(); }

}  // namespace zwang::god
