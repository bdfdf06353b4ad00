#include <zwang/collision/broad_phase.h>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include <algorithm>

namespace zwang::collision {
namespace {

// FCL's objects take their box from a geometry: this one is only a box, in world axes.
struct BoxOnly final : fcl::CollisionGeometry<double> {
  void computeLocalAABB() override {}
};

struct Proxy {
  std::shared_ptr<BoxOnly> geometry = std::make_shared<BoxOnly>();
  fcl::CollisionObject<double> object{geometry};
  int box = 0;

  void set(const Vec3& low, const Vec3& high) {
    geometry->aabb_local = fcl::AABB<double>(low, high);
    object.computeAABB();  // identity transform: the box itself
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
  proxy.set(low, high);
  boxes_->tree.registerObject(&proxy.object);
  boxes_->tree.setup();
}

void BroadPhase::move(int box, const Vec3& low, const Vec3& high) {
  Proxy& proxy = *boxes_->proxies[static_cast<std::size_t>(box)];
  proxy.set(low, high);
  boxes_->tree.update(&proxy.object);
}

void BroadPhase::query(const Vec3& low, const Vec3& high, std::vector<int>& met) {
  met.clear();
  boxes_->asked.set(low, high);
  const auto note = [](fcl::CollisionObject<double>* box, fcl::CollisionObject<double>*, void* list) {
    static_cast<std::vector<int>*>(list)->push_back(static_cast<const Proxy*>(box->getUserData())->box);
    return false;  // go on
  };
  boxes_->tree.collide(&boxes_->asked.object, &met, note);
  std::sort(met.begin(), met.end());
}

}  // namespace zwang::collision
