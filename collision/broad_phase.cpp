#include <zwang/collision/broad_phase.h>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <algorithm>

namespace zwang::collision {
namespace {

// FCL's objects take their box from a geometry: this one is only a box, in world axes.
struct BoxOnly final : fcl::CollisionGeometry<double> {
  void computeLocalAABB() override {}
};

// The tree knows a box with room around it, and is told of a move only where it leaves that room: to take a leaf out
// and put it in again takes longer than many a query. Whether a query meets the box itself is asked last.
struct Proxy {
  static constexpr double room = 0.25;  // of the longest side

  std::shared_ptr<BoxOnly> geometry = std::make_shared<BoxOnly>();
  fcl::CollisionObject<double> object{geometry};
  fcl::AABB<double> own;
  int box = 0;

  void set(const fcl::AABB<double>& known) {
    geometry->aabb_local = known;
    object.computeAABB();  // identity transform: the box itself
  }
  // False where the tree knows enough of it already.
  bool move(const Vec3& low, const Vec3& high) {
    own = {low, high};
    if (object.getAABB().contain(own)) return false;
    const double more = room * (high - low).maxCoeff();
    set({low.array() - more, high.array() + more});
    return true;
  }
};

}  // namespace

struct BroadPhase::Boxes {
  std::vector<std::unique_ptr<Proxy>> proxies;
  Proxy asked;
  fcl::DynamicAABBTreeCollisionManager<double> tree;
};

BroadPhase::BroadPhase() : boxes_(std::make_unique<Boxes>()) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&&) noexcept = default;
BroadPhase& BroadPhase::operator=(BroadPhase&&) noexcept = default;

void BroadPhase::add(const Vec3& low, const Vec3& high) {
  auto& proxy = *boxes_->proxies.emplace_back(std::make_unique<Proxy>());
  proxy.box = static_cast<int>(boxes_->proxies.size()) - 1;
  proxy.object.setUserData(&proxy);
  proxy.move(low, high);
  boxes_->tree.registerObject(&proxy.object);
  boxes_->tree.setup();
}

void BroadPhase::move(int box, const Vec3& low, const Vec3& high) {
  Proxy& proxy = *boxes_->proxies[at(box)];
  if (proxy.move(low, high)) boxes_->tree.update(&proxy.object);
}

void BroadPhase::query(const Vec3& low, const Vec3& high, std::vector<int>& met) {
  met.clear();
  boxes_->asked.set({low, high});
  const auto note = [](fcl::CollisionObject<double>* box, fcl::CollisionObject<double>* asked, void* list) {
    const auto& proxy = *static_cast<const Proxy*>(box->getUserData());
    if (proxy.own.overlap(asked->getAABB())) static_cast<std::vector<int>*>(list)->push_back(proxy.box);
    return false;  // go on
  };
  boxes_->tree.collide(&boxes_->asked.object, &met, note);
  std::sort(met.begin(), met.end());
}

}  // namespace zwang::collision
