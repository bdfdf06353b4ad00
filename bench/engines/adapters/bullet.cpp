#include <btBulletDynamicsCommon.h>
#include <cmath>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;

namespace {

btVector3 vector(const Triple& t) { return {t[0], t[1], t[2]}; }
Triple triple(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btCollisionShape* made(const Shape& s) {
  if (s.kind == "plane") return new btStaticPlaneShape({0, 0, 1}, 0);
  if (s.kind == "sphere") return new btSphereShape(s.radius);
  return new btBoxShape(vector(s.half));
}

// A world is not taken apart: its process ends with it.
struct Bullet : World {
  btDefaultCollisionConfiguration configuration;
  btDiscreteDynamicsWorld& world =
      *new btDiscreteDynamicsWorld(new btCollisionDispatcher(&configuration), new btDbvtBroadphase,
                                   new btSequentialImpulseConstraintSolver, &configuration);
  std::vector<btRigidBody*> bodies;
  Scene scene;

  explicit Bullet(const Scene& given) : scene(given) {
    world.setGravity(vector(scene.gravity));
    if (scene.tuned) world.getSolverInfo().m_numIterations = 1000;
    if (scene.tuned) world.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    for (const Body& b : scene.bodies) {
      auto* all = new btCompoundShape;
      for (const Shape& s : b.shapes)
        all->addChildShape(btTransform(btQuaternion::getIdentity(), vector(s.at)), made(s));
      auto* body = bodies.emplace_back(new btRigidBody(b.free() ? b.mass : 0, nullptr,
                                                       b.shapes.size() == 1 ? made(b.shapes[0]) : all,
                                                       b.free() ? vector(b.inertia) : btVector3(0, 0, 0)));
      body->setWorldTransform(btTransform({b.turn[1], b.turn[2], b.turn[3], b.turn[0]}, vector(b.at)));
      body->setLinearVelocity(vector(b.velocity)), body->setAngularVelocity(vector(b.spin));
      body->setFriction(std::sqrt(scene.mu)), body->setRestitution(std::sqrt(scene.restitution));  // a pair multiplies
      if (b.motion == "driven") body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
      body->setActivationState(DISABLE_DEACTIVATION);
      world.addRigidBody(body);
    }
    for (const Joint& j : scene.joints) {
      const auto from = [&](btRigidBody* body) { return body->getWorldTransform().inverse() * vector(j.at); };
      btRigidBody* other = j.b < 0 ? &btTypedConstraint::getFixedBody() : bodies[j.b];
      world.addConstraint(new btPoint2PointConstraint(*bodies[j.a], *other, from(bodies[j.a]), from(other)));
    }
  }

  void step() override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      const Body& b = scene.bodies[i];
      bodies[i]->applyCentralForce(vector(b.force)), bodies[i]->applyTorque(vector(b.torque));
      if (b.motion == "driven") bodies[i]->getWorldTransform().getOrigin() += vector(b.velocity) * scene.dt;
    }
    world.stepSimulation(scene.dt, 0);
  }

  State state(int i) const override {
    const btTransform& at = bodies[i]->getWorldTransform();
    const btQuaternion q = at.getRotation();
    return {triple(at.getOrigin()),
            {q.w(), q.x(), q.y(), q.z()},
            triple(bodies[i]->getLinearVelocity()),
            triple(bodies[i]->getAngularVelocity())};
  }
};

}  // namespace

int main() {
  return serve({.engine = "bullet", .version = "3.24", .licence = "Zlib"},
               [](const Scene& s) { return std::make_unique<Bullet>(s); });
}
