#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/TranslationalJoint.hpp>
#include <dart/simulation/World.hpp>

#include <zwang/bench/engines/adapters/protocol.h>

namespace {

namespace zw = zwang::engines;
using namespace dart::dynamics;
const auto vector = zw::as<Eigen::Vector3d>;

struct Dart : zw::World {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  std::vector<BodyNode*> bodies;

  // Bodies that hang on others have no other freedom; those that are not free are moved.
  BodyNode* made(const zw::Body& b, const zw::Joint* joint) {
    BodyNode* parent = joint && joint->b >= 0 ? bodies[joint->b] : nullptr;
    const SkeletonPtr skeleton = parent ? parent->getSkeleton() : Skeleton::create(std::to_string(bodies.size()));
    if (!parent) world->addSkeleton(skeleton);
    const Eigen::Isometry3d at(Eigen::Translation3d(vector(b.at)) *
                               Eigen::Quaterniond(b.turn[0], b.turn[1], b.turn[2], b.turn[3]));
    if (joint) {
      BallJoint::Properties ball;
      ball.mT_ParentBodyToJoint.translation() =
          vector(zw::minus(joint->at, parent ? scene.bodies[joint->b].at : zw::Triple{}));
      ball.mT_ChildBodyToJoint.translation() = vector(zw::minus(joint->at, b.at));
      const auto [held, body] = skeleton->createJointAndBodyNodePair<BallJoint>(parent, ball);
      return held->setVelocities(vector(b.spin)), body;
    }
    if (!b.free()) {
      TranslationalJoint::Properties rail;
      rail.mT_ParentBodyToJoint = at;
      const auto [moved, body] = skeleton->createJointAndBodyNodePair<TranslationalJoint>(nullptr, rail);
      return moved->setActuatorType(Joint::VELOCITY), body;
    }
    const auto [free, body] = skeleton->createJointAndBodyNodePair<FreeJoint>();
    free->setTransform(at), free->setLinearVelocity(vector(b.velocity)), free->setAngularVelocity(vector(b.spin));
    return body;
  }

  explicit Dart(const zw::Scene& given) : zw::World(given) {
    world->setTimeStep(scene.dt), world->setGravity(vector(scene.gravity));
    if (scene.tuned)
      world->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    for (const zw::Body& b : scene.bodies) {
      BodyNode* body = bodies.emplace_back(made(b, scene.holds(static_cast<int>(bodies.size()))));
      body->setInertia(Inertia(b.mass, Eigen::Vector3d::Zero(), vector(b.inertia).asDiagonal()));
      for (const zw::Shape& s : b.shapes) {
        const bool plane = s.kind == "plane";  // its own detector knows none: a box of 40 m
        const Eigen::Vector3d sides = plane ? Eigen::Vector3d(40, 40, 2) : Eigen::Vector3d(2 * vector(s.half));
        const ShapePtr shape = s.radius > 0 ? ShapePtr(new SphereShape(s.radius)) : ShapePtr(new BoxShape(sides));
        auto* node = body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
        node->setRelativeTranslation(plane ? Eigen::Vector3d(0, 0, -1) : vector(s.at));
        node->getDynamicsAspect()->setFrictionCoeff(scene.mu),
            node->getDynamicsAspect()->setRestitutionCoeff(scene.restitution);
      }
    }
  }

  void step() override {
    for (int i = 0; i < scene.size(); ++i) {
      const zw::Body& b = scene.bodies[i];
      if (!b.free()) bodies[i]->getParentJoint()->setCommands(vector(b.velocity));
      bodies[i]->addExtForce(vector(b.force)), bodies[i]->addExtTorque(vector(b.torque), false);
    }
    world->step();
  }

  zw::State state(int i) const override {
    const BodyNode& b = *bodies[i];
    const Eigen::Quaterniond q(b.getWorldTransform().linear());
    return {zw::triple(b.getWorldTransform().translation()),
            {q.w(), q.x(), q.y(), q.z()},
            zw::triple(b.getLinearVelocity()),
            zw::triple(b.getAngularVelocity())};
  }
};

}  // namespace

int main() {
  return zw::serve<Dart>({.engine = "dart", .version = DART_VERSION, .licence = "BSD-2-Clause", .alone = true});
}
