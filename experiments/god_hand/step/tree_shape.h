#pragma once

#include <BulletCollision/CollisionDispatch/btConvexConcaveCollisionAlgorithm.h>

#include <memory>

#include <zwang/collision/narrow_phase/closest.h>
#include <zwang/collision/narrow_phase/patch.h>
#include <zwang/collision/tree.h>
#include <zwang/experiments/god_hand/step/engine_numbers.h>

namespace zwang::god {

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
    btTransformAabb(vector(tree_->low()), vector(tree_->high()), 0, t, low, high);
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
    Narrowed(const Narrowed&) = delete;
    Narrowed& operator=(const Narrowed&) = delete;

    bool meets(const collision::TreeNode& node) const {
      collision::Region::LocalBox seen;
      return !region_.misses(node, seen);
    }
    bool meets(const collision::Triangle& triangle) const {
      const Pose<double>& at = region_.a_in_b;
      collision::Triangle local;
      for (std::size_t k = 0; k < 3; ++k)
        local.corner[k] = at.rotation.transpose() * (triangle.corner[k] - at.position);
      const auto [p, q, r] = local.corner;
      return (p.cwiseMin(q).cwiseMin(r).array() <= region_.local_high.array()).all() &&
             (p.cwiseMax(q).cwiseMax(r).array() >= region_.local_low.array()).all() &&
             collision::closest(region_.shape, local, reach_).distance < reach_;
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

inline btDefaultCollisionConstructionInfo with_room_for_trees() {
  btDefaultCollisionConstructionInfo info;
  info.m_customCollisionAlgorithmMaxElementSize = sizeof(TreeAlgorithm);
  return info;
}

}  // namespace zwang::god
