#include <zwang/experiments/god_hand/step/physics.h>

#include <btBulletDynamicsCommon.h>

#include <stdexcept>

#include <zwang/experiments/god_hand/step/tree_shape.h>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet must be built and used in double precision");

namespace zwang::god {
namespace {

using collision::Core;
using collision::Shape;

std::unique_ptr<btCollisionShape> convex(const Shape& shape) {
  switch (shape.core()) {
    case Core::point:
      return std::make_unique<btSphereShape>(shape.radius());
    case Core::segment:
      return std::make_unique<btCapsuleShape>(shape.radius(), 2 * shape.half().y());
    case Core::box: {
      auto box = std::make_unique<btBoxShape>(vector(Vec3(shape.half() + Vec3::Constant(shape.radius()))));
      box->setMargin(shape.radius());
      return box;
    }
    case Core::hull:
      break;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& corner : shape.corners()) hull->addPoint(vector(corner), false);
  hull->setMargin(shape.radius());
  hull->recalcLocalAabb();
  return hull;
}

bool at_origin(const Pose<double>& pose) { return pose.position.isZero(0) && pose.rotation.isIdentity(0); }

}  // namespace

struct Physics::World {
  struct State {
    Pose<double> pose;
    Vec<double, 6> velocity = Vec<double, 6>::Zero();
  };

  // What the engine builds up as it runs.
  struct Engine {
    btDefaultCollisionConfiguration configuration{with_room_for_trees()};
    TreeAlgorithm::Create create{false}, create_swapped{true};
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broad_phase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
    std::vector<std::unique_ptr<btRigidBody>> bodies;

    Engine() {
      for (const int convex :
           {SPHERE_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE}) {
        dispatcher.registerCollisionCreateFunc(convex, FAST_CONCAVE_MESH_PROXYTYPE, &create);
        dispatcher.registerCollisionCreateFunc(FAST_CONCAVE_MESH_PROXYTYPE, convex, &create_swapped);
      }
    }
    ~Engine() {
      for (const auto& body : bodies) world.removeRigidBody(body.get());
    }
  };

  std::vector<Object> objects;
  Vec3 gravity;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;  // pieces and compounds, all
  std::vector<btCollisionShape*> shape_of;                // by object
  std::unique_ptr<Engine> engine;

  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape) {
    return shapes.emplace_back(std::move(shape)).get();
  }
  btCollisionShape* keep_convex(const Shape& shape) {
    btCollisionShape* kept = keep(convex(shape));
    kept->setUserPointer(const_cast<Shape*>(&shape));  // for TreeShape::Narrowed
    return kept;
  }
  btCollisionShape* shape_for(const Object& object);
  void build(const std::vector<State>& states);
  void put(std::size_t object, const State& state);
  State state(std::size_t object) const {
    const btRigidBody& body = *engine->bodies[object];
    State s{pose_of(body.getCenterOfMassTransform())};
    s.velocity << vector(body.getLinearVelocity()), vector(body.getAngularVelocity());
    return s;
  }
};

btCollisionShape* Physics::World::shape_for(const Object& object) {
  if (object.pieces.empty()) return keep(std::make_unique<TreeShape>(object.mesh));
  if (object.pieces.size() == 1 && at_origin(object.pieces[0].at)) return keep_convex(object.pieces[0].shape);
  auto compound = std::make_unique<btCompoundShape>();
  for (const Object::Piece& piece : object.pieces)
    compound->addChildShape(transform(piece.at), keep_convex(piece.shape));
  return keep(std::move(compound));
}

// Nothing sleeps: an impulse on a sleeping body is lost, and when it fell asleep would be one more thing to remember.
// The engine multiplies the friction of two bodies; with roots the pair has the geometric mean. Penetrations are
// corrected apart from the velocities (split impulses) and leave no bounce behind.
void Physics::World::build(const std::vector<State>& states) {
  engine = nullptr;
  engine = std::make_unique<Engine>();
  engine->world.setGravity(vector(gravity));
  engine->world.getSolverInfo().m_numIterations = 30;
  engine->world.getSolverInfo().m_splitImpulse = 1;
  engine->world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
  engine->configuration.setConvexConvexMultipointIterations(4, 4);
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Object& object = objects[k];
    const btVector3 inertia = object.loose() ? vector(Vec3(object.inertia.diagonal())) : btVector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(object.mass, nullptr, shape_of[k], inertia);
    info.m_friction = std::sqrt(object.friction);
    info.m_startWorldTransform = transform(states[k].pose);
    auto& body = engine->bodies.emplace_back(std::make_unique<btRigidBody>(info));
    if (object.loose()) {
      body->setActivationState(DISABLE_DEACTIVATION);
      double thinnest = 1;
      for (const Object::Piece& p : object.pieces)
        thinnest = std::min(thinnest, p.shape.radius() + (p.shape.core() == Core::box ? p.shape.half().minCoeff() : 0));
      body->setCcdMotionThreshold(thinnest);
      body->setCcdSweptSphereRadius(0.8 * thinnest);
    }
    engine->world.addRigidBody(body.get());
    put(k, states[k]);
  }
}

void Physics::World::put(std::size_t object, const State& state) {
  btRigidBody& body = *engine->bodies[object];
  const btTransform t = transform(state.pose);
  body.setWorldTransform(t);
  body.setLinearVelocity(vector(Vec3(state.velocity.head<3>())));
  body.setAngularVelocity(vector(Vec3(state.velocity.tail<3>())));
  body.setCenterOfMassTransform(t);
  engine->world.updateSingleAabb(&body);
}

Physics::Physics(const Surroundings& surroundings) : world_(std::make_unique<World>()) {
  world_->gravity = surroundings.gravity;
  world_->objects = surroundings.objects;
  std::vector<World::State> states;
  for (const Object& object : world_->objects) {
    const Mat3 mixed = object.inertia - Mat3(object.inertia.diagonal().asDiagonal());
    if (object.loose() && mixed.cwiseAbs().maxCoeff() > 1e-9 * object.inertia.trace())
      throw std::invalid_argument(object.name + ": axes are not the principal ones (inertia is not diagonal)");
    if (object.pieces.empty() && (object.loose() || !object.mesh))
      throw std::invalid_argument(object.name + ": no shape that the physics engine could use");
    world_->shape_of.push_back(world_->shape_for(object));
    states.push_back({object.pose});
  }
  world_->build(states);
}

Physics::~Physics() = default;

void Physics::step(double dt, std::span<const Vec<double, 6>> wrench) {
  for (std::size_t k = 0; k < wrench.size(); ++k) {
    if (!world_->objects[k].loose() || wrench[k].isZero(0)) continue;
    btRigidBody& body = *world_->engine->bodies[k];
    body.applyCentralForce(vector(Vec3(wrench[k].head<3>())));
    body.applyTorque(vector(Vec3(wrench[k].tail<3>())));
  }
  world_->engine->world.stepSimulation(dt, 0);
}

Pose<double> Physics::pose(std::size_t object) const { return world_->state(object).pose; }
Vec<double, 6> Physics::velocity(std::size_t object) const { return world_->state(object).velocity; }

void Physics::place(std::size_t object, const Pose<double>& pose, const Vec<double, 6>& velocity) {
  world_->put(object, {pose, velocity});
}

void Physics::forget() {
  std::vector<World::State> states;
  for (std::size_t k = 0; k < world_->objects.size(); ++k) states.push_back(world_->state(k));
  world_->build(states);
}

}  // namespace zwang::god
