#include <zwang/experiments/god_hand/step/physics.h>

#include <BulletCollision/CollisionDispatch/btConvexConcaveCollisionAlgorithm.h>
#include <btBulletDynamicsCommon.h>

#include <stdexcept>

#include <zwang/collision/narrow_phase/closest.h>
#include <zwang/collision/narrow_phase/patch.h>

static_assert(sizeof(btScalar) == sizeof(double), "Bullet must be built and used in double precision");

namespace zwang::god {
namespace {

using collision::Core;
using collision::Shape;

btVector3 vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vec3 vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform transform(const Pose<double>& pose) {
  const Mat3& R = pose.rotation;
  const btMatrix3x3 basis(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
  return btTransform(basis, vector(pose.position));
}

Pose<double> pose_of(const btTransform& t) {
  Pose<double> pose{vector(t.getOrigin()), {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) pose.rotation(i, j) = t.getBasis()[i][j];
  return pose;
}

// A mesh as the engine sees it: the triangles of the tree that collision/ holds already. A btBvhTriangleMeshShape would
// build and keep a tree of its own, which for a million triangles takes longer than all the rest of a scene. (The
// engine takes CUSTOM_CONCAVE_SHAPE_TYPE for a signed distance field; this type is free, and treated like any mesh.)
//
// The engine asks for the triangles in a box along the mesh's axes. About a can that leans on a part of 30,000
// triangles that is 3,600 of them, each of which it then measures. While a Narrowed lives they are those in the box
// along the can's own axes.
class TreeShape : public btConcaveShape {
 public:
  explicit TreeShape(std::shared_ptr<const collision::Tree> tree) : tree_(std::move(tree)) {
    m_shapeType = FAST_CONCAVE_MESH_PROXYTYPE;
    setMargin(0);
  }

  void processAllTriangles(btTriangleCallback* callback, const btVector3& low, const btVector3& high) const override {
    const auto enter = [&](const collision::TreeNode& node, std::size_t) {
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k)
        meets = meets && node.low[k] <= high.m_floats[k] && node.high[k] >= low.m_floats[k];
      return meets && (!narrowed_ || narrowed_->meets(node));
    };
    tree_->walk(enter, [&](std::uint32_t t, std::uint32_t end) {
      for (; t < end; ++t) {
        if (narrowed_ && !narrowed_->meets(tree_->triangle(t))) continue;
        const auto [a, b, c] = tree_->triangle(t).corner;
        btVector3 corners[3] = {vector(a), vector(b), vector(c)};
        callback->processTriangle(corners, 0, static_cast<int>(t));
      }
    });
  }
  void getAabb(const btTransform& t, btVector3& low, btVector3& high) const override {
    btTransformAabb(vector(tree_->box().min()), vector(tree_->box().max()), 0, t, low, high);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  void setLocalScaling(const btVector3&) override {}
  const btVector3& getLocalScaling() const override { return scaling_; }
  const char* getName() const override { return "zwang tree"; }

  // No triangle beyond its reach gives the convex body a contact. The body's shape points to that of collision/.
  class Narrowed {
   public:
    Narrowed(const btCollisionObjectWrapper& convex, const btCollisionObjectWrapper& mesh)
        : tree_(*static_cast<const TreeShape*>(mesh.getCollisionShape())),
          reach_(static_cast<const collision::Shape*>(convex.getCollisionShape()->getUserPointer())->radius() +
                 convex.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold)),
          region_(*static_cast<const collision::Shape*>(convex.getCollisionShape()->getUserPointer()),
                  pose_of(mesh.getWorldTransform().inverseTimes(convex.getWorldTransform())), reach_) {
      tree_.narrowed_ = this;
    }
    ~Narrowed() { tree_.narrowed_ = nullptr; }
    Narrowed(Narrowed&&) = delete;

    bool meets(const collision::TreeNode& node) const {
      collision::Region::LocalBox seen;
      return !region_.misses(node, seen);
    }
    bool meets(const collision::Triangle& triangle) const {
      const Pose<double>& at = region_.a_in_b;
      collision::Triangle local;
      for (std::size_t k = 0; k < 3; ++k)
        local.corner[k] = at.rotation.transpose() * (triangle.corner[k] - at.position);
      return !region_.misses(local) && collision::closest(region_.shape, local, reach_).distance < reach_;
    }

   private:
    const TreeShape& tree_;
    double reach_;  // m, of the body's core
    collision::Region region_;
  };

 private:
  std::shared_ptr<const collision::Tree> tree_;
  btVector3 scaling_ = {1, 1, 1};
  mutable const Narrowed* narrowed_ = nullptr;
};

// Convex bodies against a TreeShape.
class TreeAlgorithm : public btConvexConcaveCollisionAlgorithm {
 public:
  TreeAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* a,
                const btCollisionObjectWrapper* b, bool swapped)
      : btConvexConcaveCollisionAlgorithm(info, a, b, swapped), swapped_(swapped) {}

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                        const btDispatcherInfo& info, btManifoldResult* result) override {
    const TreeShape::Narrowed narrowed(swapped_ ? *b : *a, swapped_ ? *a : *b);
    btConvexConcaveCollisionAlgorithm::processCollision(a, b, info, result);
  }

  struct Create : btCollisionAlgorithmCreateFunc {
    explicit Create(bool swapped) { m_swapped = swapped; }
    btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                   const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b) override {
      void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(TreeAlgorithm));
      return new (memory) TreeAlgorithm(info, a, b, m_swapped);
    }
  };

 private:
  bool swapped_;
};

btDefaultCollisionConstructionInfo with_room_for_trees() {
  btDefaultCollisionConstructionInfo info;
  info.m_customCollisionAlgorithmMaxElementSize = sizeof(TreeAlgorithm);
  return info;
}

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
    std::unique_ptr<btCollisionAlgorithmCreateFunc> create = std::make_unique<TreeAlgorithm::Create>(false),
                                                    create_swapped = std::make_unique<TreeAlgorithm::Create>(true);
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broad_phase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
    std::vector<std::unique_ptr<btRigidBody>> bodies;

    Engine() {
      for (const int convex :
           {SPHERE_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE, BOX_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE}) {
        dispatcher.registerCollisionCreateFunc(convex, FAST_CONCAVE_MESH_PROXYTYPE, create.get());
        dispatcher.registerCollisionCreateFunc(FAST_CONCAVE_MESH_PROXYTYPE, convex, create_swapped.get());
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
