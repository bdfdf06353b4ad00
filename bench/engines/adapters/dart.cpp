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
#include <map>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;
using namespace dart::dynamics;
using Eigen::Vector3d;

namespace {

struct Dart : World {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  std::map<int, BodyNode*> bodies;

  // A body, and then those that hang on it by a joint: these have no other freedom.
  void add(int i) {
    const Body& b = scene.bodies[i];
    const zwang::engines::Joint* joint = scene.holds(i);
    BodyNode* parent = joint && joint->b >= 0 ? bodies.at(joint->b) : nullptr;
    const SkeletonPtr skeleton = parent ? parent->getSkeleton() : Skeleton::create(std::to_string(i));
    BallJoint::Properties ball;
    TranslationalJoint::Properties rail;
    Eigen::Isometry3d at(Eigen::Translation3d(as<Vector3d>(b.at)) *
                         Eigen::Quaterniond(b.turn[0], b.turn[1], b.turn[2], b.turn[3]));
    rail.mT_ParentBodyToJoint = at;
    if (joint) {
      ball.mT_ParentBodyToJoint.translation() =
          as<Vector3d>(minus(joint->at, parent ? scene.bodies[joint->b].at : Triple{}));
      ball.mT_ChildBodyToJoint.translation() = as<Vector3d>(minus(joint->at, b.at));
      bodies[i] = skeleton->createJointAndBodyNodePair<BallJoint>(parent, ball).second;
      bodies[i]->getParentJoint()->setVelocities(as<Vector3d>(b.spin));
    } else if (b.free()) {
      const auto [free, body] = skeleton->createJointAndBodyNodePair<FreeJoint>();
      free->setTransform(at), free->setLinearVelocity(as<Vector3d>(b.velocity)),
          free->setAngularVelocity(as<Vector3d>(b.spin));
      bodies[i] = body;
    } else {
      bodies[i] = skeleton->createJointAndBodyNodePair<TranslationalJoint>(nullptr, rail).second;
      bodies[i]->getParentJoint()->setActuatorType(dart::dynamics::Joint::VELOCITY);
    }
    bodies[i]->setInertia(Inertia(b.mass, Vector3d::Zero(), as<Vector3d>(b.inertia).asDiagonal()));
    for (const zwang::engines::Shape& s : b.shapes) {
      const bool plane = s.kind == "plane";  // its own detector knows none: a box of 40 m
      const Vector3d sides = plane ? Vector3d(40, 40, 2) : Vector3d(2 * as<Vector3d>(s.half));
      ShapePtr shape;
      if (s.kind == "sphere")
        shape = std::make_shared<SphereShape>(s.radius);
      else
        shape = std::make_shared<BoxShape>(sides);
      auto* node = bodies[i]->createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
      node->setRelativeTranslation(plane ? Vector3d(0, 0, -1) : as<Vector3d>(s.at));
      node->getDynamicsAspect()->setFrictionCoeff(scene.mu),
          node->getDynamicsAspect()->setRestitutionCoeff(scene.restitution);
    }
    if (!parent) world->addSkeleton(skeleton);
    for (const zwang::engines::Joint& j : scene.joints)
      if (j.b == i) add(j.a);
  }

  explicit Dart(const Scene& given) : World(given) {
    world->setTimeStep(scene.dt), world->setGravity(as<Vector3d>(scene.gravity));
    if (scene.tuned)
      world->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    for (int i = 0; i < scene.size(); ++i)
      if (!scene.holds(i) || scene.holds(i)->b < 0) add(i);
  }

  void step() override {
    for (const auto& [i, body] : bodies) {
      const Body& b = scene.bodies[i];
      if (!b.free()) body->getParentJoint()->setCommands(as<Vector3d>(b.velocity));
      body->addExtForce(as<Vector3d>(b.force)), body->addExtTorque(as<Vector3d>(b.torque), false);
    }
    world->step();
  }

  State state(int i) const override {
    const BodyNode& b = *bodies.at(i);
    const Eigen::Quaterniond q(b.getWorldTransform().linear());
    return {triple(b.getWorldTransform().translation()),
            {q.w(), q.x(), q.y(), q.z()},
            triple(b.getLinearVelocity()),
            triple(b.getAngularVelocity())};
  }
};

}  // namespace

int main() { return serve<Dart>({.engine = "dart", .version = DART_VERSION, .licence = "BSD-2-Clause"}); }
