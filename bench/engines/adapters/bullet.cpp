#include <btBulletDynamicsCommon.h>
#include <cmath>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;

namespace {

const auto vector = as<btVector3>;

btCollisionShape* made(const Shape& s) {
  if (s.kind == "plane") return new btStaticPlaneShape({0, 0, 1}, 0);
  if (s.kind == "sphere") return new btSphereShape(s.radius);
  return new btBoxShape(vector(s.half));
}

struct Bullet : World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher pairs{&configuration};
  btDiscreteDynamicsWorld world{&pairs, new btDbvtBroadphase, new btSequentialImpulseConstraintSolver, &configuration};
  std::vector<btRigidBody*> bodies;

  explicit Bullet(const Scene& given) : World(given) {
    world.setGravity(vector(scene.gravity));
    if (scene.tuned) world.getSolverInfo().m_numIterations = 1000;
    if (scene.tuned) configuration.setPlaneConvexMultipointIterations(4, 4);  // all corners at once
    for (const Body& b : scene.bodies) {
      auto* all = new btCompoundShape;
      for (const Shape& s : b.shapes) all->addChildShape(btTransform({0, 0, 0, 1}, vector(s.at)), made(s));
      btCollisionShape* shape = b.shapes.size() == 1 ? made(b.shapes[0]) : all;
      const Triple inertia = b.free() ? b.inertia : Triple{};
      auto* body = bodies.emplace_back(new btRigidBody(b.free() ? b.mass : 0, nullptr, shape, vector(inertia)));
      body->setWorldTransform(btTransform({b.turn[1], b.turn[2], b.turn[3], b.turn[0]}, vector(b.at)));
      body->setLinearVelocity(vector(b.velocity)), body->setAngularVelocity(vector(b.spin));
      body->setFriction(std::sqrt(scene.mu)), body->setRestitution(std::sqrt(scene.restitution));  // a pair multiplies
      if (b.motion == "driven") body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
      body->setActivationState(DISABLE_DEACTIVATION);
      world.addRigidBody(body);
    }
    for (const Joint& j : scene.joints) {
      btRigidBody &a = *bodies[j.a], &b = j.b < 0 ? btTypedConstraint::getFixedBody() : *bodies[j.b];
      const auto from = [&](btRigidBody& body) { return body.getWorldTransform().inverse() * vector(j.at); };
      world.addConstraint(new btPoint2PointConstraint(a, b, from(a), from(b)));
    }
  }

  void push(int i, const Body& b) override {
    bodies[i]->applyCentralForce(vector(b.force)), bodies[i]->applyTorque(vector(b.torque));
    if (b.motion == "driven") bodies[i]->getWorldTransform().getOrigin() += vector(b.velocity) * scene.dt;
  }
  void advance() override { world.stepSimulation(scene.dt, 0); }

  State state(int i) const override {
    const btRigidBody& b = *bodies[i];
    const btTransform& at = b.getWorldTransform();
    return state_of(at.getOrigin(), at.getRotation(), b.getLinearVelocity(), b.getAngularVelocity());
  }
};

}  // namespace

int main() { return serve<Bullet>({.engine = "bullet", .version = "3.24", .licence = "Zlib"}); }
