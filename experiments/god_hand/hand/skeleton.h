#pragma once

#include <span>
#include <variant>
#include <vector>

#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/model/scene.h>

namespace zwang::god {

// visit(list) for the lists of a scene's joints, of each kind that a skeleton may have.
template <class Visit>
void each_joint_list(Scene& scene, const Visit& visit) {
  visit(scene.list_of<BallJoint>());
  visit(scene.list_of<RevoluteJoint>());
  visit(scene.list_of<UniversalJoint>());
  visit(scene.list_of<Weld>());
}

// The joints of a scene as a forest of bodies, to put poses exactly onto joints and limits.
//
// A linear step and the exponential map leave joints open (docs/formulation.md: 1.1e-2 m at 0.5 rad a joint). Newton's
// method on the rows would close them in two or three more solves a frame; a forest needs none: from the roots outward,
// each body keeps as much of its own rotation as its joint leaves it (the smallest turn that brings the axes into
// line), is turned back to a limit that it is beyond, and is put where its anchor meets its parent's. Joints then hold
// to rounding, whatever the pose was, and poses that already hold do not move.
class Skeleton {
 public:
  // Throws std::invalid_argument when joints close a loop, or a joint's second body has two of them.
  explicit Skeleton(Scene scene);

  // `poses`: one per body at least. With `limits`, angles are kept within their ranges too.
  void close(std::span<Pose<double>> poses, bool limits) const;

  double separation(PoseSpan poses) const;  // m, the largest gap between two anchors
  double excess(PoseSpan poses) const;      // rad, how far the worst angle is beyond its range

 private:
  using Joint = std::variant<BallJoint, RevoluteJoint, UniversalJoint, Weld>;
  struct Link {
    Joint joint;
    std::array<BodyId, 2> bodies;  // parent, child
    std::vector<JointLimit> limits = {};
  };

  std::size_t bodies_ = 0;
  std::vector<Link> links_;  // parents first
};

}  // namespace zwang::god
