#include <zwang/bench/scenes/scene_change.h>

#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>
#include "docs/leash.h"

namespace zwang {

Problem scene_change(const Instance& instance, const SceneChange& change) {
  if (!instance.step) throw std::invalid_argument("'" + instance.problem.name + "' is not made of bodies by a scene");
  return changed<BallJoint, Contact, Distance, JointLimit, Leash, PrismaticJoint, RevoluteJoint, Rope, UniversalJoint,
                 Weld>(*instance.step, change);
}

}  // namespace zwang
