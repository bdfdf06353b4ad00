#include <zwang/bench/collision/witness.h>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include <zwang/bench/collision/hull_faces.h>

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

struct Primitive {
  std::shared_ptr<fcl::CollisionGeometry<double>> geometry;
  Pose<double> place;  // in the shape's axes
};

std::shared_ptr<Model> model_of(const std::vector<Vec3>& points, const std::vector<fcl::Triangle>& triangles) {
  auto model = std::make_shared<Model>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
  model->addSubModel(points, triangles);
  if (model->endModel() != fcl::BVH_OK) throw std::runtime_error("FCL could not build a tree");
  model->computeLocalAABB();
  return model;
}

// The faces of the hull of these corners, moved outward by r. Null where they lie in a line: their capsule is all of
// such a shape.
std::shared_ptr<Model> swept_faces(std::span<const Vec3> corners, double r) {
  std::vector<Vec3> points;
  std::vector<fcl::Triangle> triangles;
  for (const HullFace& face : hull_faces(corners)) {
    triangles.emplace_back(points.size(), points.size() + 1, points.size() + 2);
    for (const std::size_t c : face.corners) points.push_back(corners[c] + r * face.normal);
  }
  return triangles.empty() ? nullptr : model_of(points, triangles);
}

std::vector<Primitive> primitives(const Shape& shape) {
  const double r = shape.radius();
  const auto corners = shape.corners();
  std::vector<Primitive> out;
  if (shape.core() == Core::point) return {{std::make_shared<fcl::Sphere<double>>(r), {corners[0], Mat3::Identity()}}};
  if (shape.core() == Core::box)
    for (int k = 0; k < 3; ++k) {
      const Vec3 widths = 2 * (shape.half() + r * Vec3::Unit(k));
      out.push_back({std::make_shared<fcl::Box<double>>(widths), {}});
    }
  if (shape.core() == Core::hull)
    if (const auto faces = swept_faces(corners, r)) out.push_back({faces, {}});
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 edge = corners[j] - corners[i];
      if (shape.core() == Core::box && (edge.array() != 0).count() != 1) continue;  // a diagonal
      out.push_back({std::make_shared<fcl::Capsule<double>>(r, edge.norm()), between(corners[i], corners[j])});
    }
  return out;
}

bool collide(const fcl::CollisionGeometry<double>& a, const Pose<double>& of_a, const fcl::CollisionGeometry<double>& b,
             const Pose<double>& of_b) {
  fcl::CollisionRequest<double> request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResult<double> result;
  fcl::collide(&a, transform(of_a), &b, transform(of_b), request, result);
  return result.isCollision();
}

}  // namespace

struct Witness::Models {
  std::vector<std::shared_ptr<Model>> all;
  std::vector<std::shared_ptr<const collision::Tree>> trees;
  mutable std::map<const Shape*, std::vector<Primitive>> known;

  const std::vector<Primitive>& of(const Shape& shape) const {
    const auto [at, fresh] = known.try_emplace(&shape);
    if (fresh) at->second = primitives(shape);
    return at->second;
  }
};

Witness::Witness(std::span<const std::shared_ptr<const collision::Tree>> meshes) : models_(std::make_unique<Models>()) {
  for (const auto& tree : meshes) {
    std::vector<Vec3> corners;
    std::vector<fcl::Triangle> triangles;
    for (const collision::Triangle& t : tree->triangles()) {
      triangles.emplace_back(corners.size(), corners.size() + 1, corners.size() + 2);
      corners.insert(corners.end(), t.corner.begin(), t.corner.end());
    }
    models_->all.push_back(model_of(corners, triangles));
    models_->trees.push_back(tree);
  }
}

Witness::~Witness() = default;

bool Witness::overlaps(const Shape& shape, const Pose<double>& pose, std::size_t mesh,
                       const Pose<double>& of_mesh) const {
  // Boxes first: most pairs of a scene are far apart.
  const Eigen::AlignedBox3d& box = models_->trees[mesh]->box();
  const Vec3 local = of_mesh.rotation.transpose() * (pose.position - of_mesh.position);
  const double reach = shape.reach() + shape.radius();
  if ((local.array() + reach < box.min().array()).any() || (local.array() - reach > box.max().array()).any())
    return false;
  return std::ranges::any_of(models_->of(shape), [&](const Primitive& primitive) {
    return collide(*models_->all[mesh], of_mesh, *primitive.geometry, placed(pose, primitive.place));
  });
}

bool Witness::overlaps(const Shape& shape, const Pose<double>& pose, const Shape& other,
                       const Pose<double>& of_other) const {
  const double reach = shape.reach() + shape.radius() + other.reach() + other.radius();
  if ((pose.position - of_other.position).squaredNorm() > reach * reach) return false;
  for (const Primitive& a : models_->of(shape))
    for (const Primitive& b : models_->of(other))
      if (collide(*b.geometry, placed(of_other, b.place), *a.geometry, placed(pose, a.place))) return true;
  return false;
}

double Witness::advance(const Shape& shape, const Pose<double>& pose, const Vec<double, 6>& twist, std::size_t mesh,
                        double stop) const {
  fcl::DistanceRequest<double> request;
  request.distance_tolerance = 1e-9;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  const Primitive& primitive = models_->of(shape).front();
  const double speed = twist.head<3>().norm() + twist.tail<3>().norm() * shape.reach();
  double s = 0;
  for (int step = 0; step < 1000; ++step) {
    fcl::DistanceResult<double> result;
    const Pose<double> here = placed(retract(pose, Vec<double, 6>(s * twist)), primitive.place);
    const double d = fcl::distance(models_->all[mesh].get(), Transform::Identity(), primitive.geometry.get(),
                                   transform(here), request, result);
    if (d <= stop) return s;
    s += (d - stop / 2) / speed;
    if (s >= 1) return 1;
  }
  return s;
}

}  // namespace zwang
