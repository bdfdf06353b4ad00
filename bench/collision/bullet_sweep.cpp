#include <zwang/bench/collision/bullet_sweep.h>

#include <btBulletCollisionCommon.h>

namespace zwang {
namespace {

btTransform transform(const Pose<double>& pose) {
  const Mat3& R = pose.rotation;
  const Vec3& p = pose.position;
  return btTransform(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
                     btVector3(p.x(), p.y(), p.z()));
}

}  // namespace

struct BulletSweep::World {
  btTriangleMesh triangles;
  std::unique_ptr<btBvhTriangleMeshShape> shape;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  btCollisionWorld world{&dispatcher, &broad_phase, &configuration};
  btCollisionObject object;
};

BulletSweep::BulletSweep(const collision::Tree& mesh) : world_(std::make_unique<World>()) {
  const auto point = [](const Vec3& p) { return btVector3(p.x(), p.y(), p.z()); };
  for (const collision::Triangle& t : mesh.triangles())
    world_->triangles.addTriangle(point(t.corner[0]), point(t.corner[1]), point(t.corner[2]));
  world_->shape = std::make_unique<btBvhTriangleMeshShape>(&world_->triangles, true);
  world_->shape->setMargin(0);
  world_->object.setCollisionShape(world_->shape.get());
  world_->world.addCollisionObject(&world_->object);
}

BulletSweep::~BulletSweep() { world_->world.removeCollisionObject(&world_->object); }

double BulletSweep::time(const collision::Shape& shape, const Pose<double>& from, const Pose<double>& to) const {
  const btCapsuleShape capsule(shape.radius(), 2 * shape.half().y());  // along y, as ours
  btCollisionWorld::ClosestConvexResultCallback found(transform(from).getOrigin(), transform(to).getOrigin());
  world_->world.convexSweepTest(&capsule, transform(from), transform(to), found);
  return found.m_closestHitFraction;
}

}  // namespace zwang
