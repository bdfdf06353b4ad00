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
using Eigen::Isometry3d;
const auto vector = zw::as<Eigen::Vector3d>;

struct Dart : zw::World {
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  std::vector<BodyNode*> bodies;

  template <class Kind>
  std::pair<Kind*, BodyNode*> hung(BodyNode* parent = nullptr) {
    const SkeletonPtr skeleton = parent ? parent->getSkeleton() : Skeleton::create(std::to_string(bodies.size()));
    if (!parent) world->addSkeleton(skeleton);
    return skeleton->createJointAndBodyNodePair<Kind>(parent);
  }

  // Bodies that hang on others have no other freedom; those that are not free are moved.
  BodyNode* made(const zw::Body& b, const zw::Joint* joint) {
    const auto from = [&](int k) { return Isometry3d(Eigen::Translation3d(vector(scene.seen_from(k, joint->at)))); };
    if (joint) {
      const auto [held, body] = hung<BallJoint>(joint->b < 0 ? nullptr : bodies[joint->b]);
      held->setTransformFromParentBodyNode(from(joint->b)), held->setTransformFromChildBodyNode(from(joint->a));
      return held->setVelocities(vector(b.spin)), body;
    }
    const Isometry3d at(Eigen::Translation3d(vector(b.at)) * zw::turn_as<Eigen::Quaterniond>(b.turn));
    if (b.free()) {
      const auto [free, body] = hung<FreeJoint>();
      free->setTransform(at), free->setLinearVelocity(vector(b.velocity));
      return free->setAngularVelocity(vector(b.spin)), body;
    }
    const auto [moved, body] = hung<TranslationalJoint>();
    return moved->setTransformFromParentBodyNode(at), moved->setActuatorType(Joint::VELOCITY), body;
  }

  explicit Dart(const zw::Scene& given) : zw::World(given) {
    world->setTimeStep(scene.dt), world->setGravity(vector(scene.gravity));
    if (scene.tuned)
      world->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    for (const zw::Body& b : scene.bodies) {
      BodyNode* body = bodies.emplace_back(made(b, scene.holds(static_cast<int>(bodies.size()))));
      body->setInertia(Inertia(b.mass, Eigen::Vector3d::Zero(), vector(b.inertia).asDiagonal()));
      for (zw::Shape s : b.shapes) {
        if (s.kind == "plane") s.half = {20, 20, 1}, s.at = {0, 0, -1};  // its own detector knows no plane
        const ShapePtr shape =
            s.radius > 0 ? ShapePtr(new SphereShape(s.radius)) : ShapePtr(new BoxShape(2 * vector(s.half)));
        auto* node = body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
        node->setRelativeTranslation(vector(s.at)), node->getDynamicsAspect()->setFrictionCoeff(scene.mu);
        node->getDynamicsAspect()->setRestitutionCoeff(scene.restitution);
      }
    }
  }

  void push(int i, const zw::Body& b) override {
    if (!b.free()) bodies[i]->getParentJoint()->setCommands(vector(b.velocity));
    bodies[i]->addExtForce(vector(b.force)), bodies[i]->addExtTorque(vector(b.torque), false);
  }
  void advance() override { world->step(); }

  zw::State state(int i) const override {
    const Isometry3d& at = bodies[i]->getWorldTransform();
    return zw::state_of(at.translation(), Eigen::Quaterniond(at.linear()), bodies[i]->getLinearVelocity(),
                        bodies[i]->getAngularVelocity());
  }
};

}  // namespace

int main() {
  return zw::serve<Dart>({.engine = "dart", .version = DART_VERSION, .licence = "BSD-2-Clause", .alone = true});
}
