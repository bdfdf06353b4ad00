#include "bench/collision/witness.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <stdexcept>

namespace zwang {
namespace {

using collision::Core;
using collision::Shape;
using Model = fcl::BVHModel<fcl::OBBRSS<double>>;
using Transform = fcl::Transform3<double>;

Transform transform(const Pose<double>& pose) {
  Transform t = Transform::Identity();
  t.linear() = pose.rotation;
  t.translation() = pose.position;
  return t;
}

// FCL's capsules lie along z.
Pose<double> between(const Vec3& p, const Vec3& q) {
  Pose<double> pose{(p + q) / 2, Mat3::Identity()};
  if (p != q) pose.rotation = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), q - p).toRotationMatrix();
  return pose;
}

struct Solid {
  std::shared_ptr<fcl::CollisionGeometry<double>> geometry;
  Pose<double> place;  // in the shape's axes
};

std::vector<Solid> solids(const Shape& shape) {
  const double r = shape.radius();
  const auto corners = shape.corners();
  std::vector<Solid> out;
  if (shape.core() == Core::point) return {{std::make_shared<fcl::Sphere<double>>(r), {corners[0], Mat3::Identity()}}};
  if (shape.core() == Core::box)
    for (int k = 0; k < 3; ++k) {
      const Vec3 widths = 2 * (shape.half() + r * Vec3::Unit(k));
      out.push_back({std::make_shared<fcl::Box<double>>(widths), {}});
    }
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 edge = corners[j] - corners[i];
      if (shape.core() == Core::box && (edge.array() != 0).count() != 1) continue;  // a diagonal
      out.push_back({std::make_shared<fcl::Capsule<double>>(r, edge.norm()), between(corners[i], corners[j])});
    }
  return out;
}

Pose<double> times(const Pose<double>& a, const Pose<double>& b) { return {a * b.position, a.rotation * b.rotation}; }

}  // namespace

struct Witness::Models {
  std::vector<std::unique_ptr<Model>> all;
  std::vector<std::shared_ptr<const collision::Tree>> trees;
  // By the shape's address: the caller's shapes outlive the questions about them.
  mutable std::vector<std::pair<const Shape*, std::vector<Solid>>> known;

  const std::vector<Solid>& of(const Shape& shape) const {
    for (const auto& [address, list] : known)
      if (address == &shape) return list;
    return known.emplace_back(&shape, solids(shape)).second;
  }
};

Witness::Witness(std::span<const std::shared_ptr<const collision::Tree>> meshes) : models_(std::make_unique<Models>()) {
  models_->known.reserve(64);
  for (const auto& tree : meshes) {
    std::vector<Vec3> corners;
    std::vector<fcl::Triangle> triangles;
    for (const collision::Triangle& t : tree->triangles()) {
      triangles.emplace_back(corners.size(), corners.size() + 1, corners.size() + 2);
      corners.insert(corners.end(), t.corner.begin(), t.corner.end());
    }
    auto& model = *models_->all.emplace_back(std::make_unique<Model>());
    model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(corners.size()));
    model.addSubModel(corners, triangles);
    if (model.endModel() != fcl::BVH_OK) throw std::runtime_error("FCL could not build a tree");
    model.computeLocalAABB();
    models_->trees.push_back(tree);
  }
}

Witness::~Witness() = default;
Witness::Witness(Witness&&) noexcept = default;

bool Witness::overlaps(const Shape& shape, const Pose<double>& pose, std::size_t mesh,
                       const Pose<double>& of_mesh) const {
  // Boxes first: most pairs of a scene are far apart.
  const collision::Tree& tree = *models_->trees[mesh];
  const Vec3 local = of_mesh.rotation.transpose() * (pose.position - of_mesh.position);
  const double reach = shape.reach() + shape.radius();
  if ((local.array() + reach < tree.low().array()).any() || (local.array() - reach > tree.high().array()).any())
    return false;
  fcl::CollisionRequest<double> request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  for (const Solid& solid : models_->of(shape)) {
    fcl::CollisionResult<double> result;
    fcl::collide(models_->all[mesh].get(), transform(of_mesh), solid.geometry.get(),
                 transform(times(pose, solid.place)), request, result);
    if (result.isCollision()) return true;
  }
  return false;
}

Witness::Advance Witness::advance(const Shape& shape, const Pose<double>& pose, const Vec<double, 6>& twist,
                                  std::size_t mesh, double stop) const {
  fcl::DistanceRequest<double> request;
  request.distance_tolerance = 1e-9;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  const Solid& solid = models_->of(shape).front();
  const double speed = twist.head<3>().norm() + twist.tail<3>().norm() * shape.reach();
  double s = 0;
  for (int steps = 1; steps <= 1000; ++steps) {
    fcl::DistanceResult<double> result;
    const Pose<double> here = times(retract(pose, Vec<double, 6>(s * twist)), solid.place);
    const double d = fcl::distance(models_->all[mesh].get(), Transform::Identity(), solid.geometry.get(),
                                   transform(here), request, result);
    if (d <= stop) return {s, steps};
    s += (d - stop / 2) / speed;
    if (s >= 1) return {1, steps};
  }
  return {s, 1000};
}

}  // namespace zwang
