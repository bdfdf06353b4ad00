#include <zwang/experiments/god_hand/scenes/depth.h>

#include <algorithm>
#include <limits>

#include <zwang/bench/collision/hull_faces.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/collision/narrow_phase/closest.h>
#include <zwang/collision/nearest.h>
#include <zwang/experiments/god_hand/hand/hand_shapes.h>

namespace zwang::god {

namespace {

using collision::Core;
using collision::Shape;
using collision::Tree;
using collision::TreeNode;

double distance_to(const Shape& shape, std::span<const HullFace> faces, const Vec3& p) {
  if (shape.core() == Core::box) {
    const Vec3 out = p.cwiseAbs() - shape.half();
    return out.cwiseMax(0).norm() + std::min(out.maxCoeff(), 0.0) - shape.radius();
  }
  double inside = -std::numeric_limits<double>::infinity();
  for (const HullFace& face : faces) inside = std::max(inside, face.normal.dot(p) - face.offset);
  if (!faces.empty() && inside <= 0) return inside - shape.radius();
  return collision::closest(std::span<const Vec3>(&p, 1), shape.corners()).distance - shape.radius();
}

bool meets(const TreeNode& node, const Vec3& p, const Vec3& inverse) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<Index>(k);
    const double a = (static_cast<double>(node.low[k]) - p[i]) * inverse[i];
    const double b = (static_cast<double>(node.high[k]) - p[i]) * inverse[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

// How often the ray leaves the surface more than it enters it.
int winding(const Tree& tree, const Vec3& p, const Vec3& along) {
  const Vec3 inverse = along.cwiseInverse();
  int sum = 0;
  const auto enter = [&](const TreeNode& node, std::size_t) { return meets(node, p, inverse); };
  tree.walk(enter, [&](std::uint32_t first, std::uint32_t end) {
    for (const collision::Triangle& t : tree.triangles(first, end)) {
      const Vec3 a = t.corner[0] - p, b = t.corner[1] - p, c = t.corner[2] - p;
      // Signed volumes over the edges: equal signs where the line passes through.
      const double u = along.dot(b.cross(c)), v = along.dot(c.cross(a)), w = along.dot(a.cross(b));
      const int sign = u > 0 && v > 0 && w > 0 ? 1 : u < 0 && v < 0 && w < 0 ? -1 : 0;
      if (sign != 0 && sign * a.dot((b - a).cross(c - a)) > 0) sum += sign;
    }
  });
  return sum;
}

bool inside(const Tree& tree, const Vec3& p) {
  static const Mat3 axes = rotation(Vec3(0.3, 0.5, 0.7));  // along nothing that parts are usually built along
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0})
      if (winding(tree, p, sign * axes.col(k)) == 0) return false;
  return true;
}

}  // namespace

struct Depth::Volume {
  struct Convex {
    Shape shape;
    Pose<double> at;
    std::vector<HullFace> faces;
  };
  Pose<double> pose;
  std::shared_ptr<const Tree> mesh;
  std::vector<Convex> pieces;
  Eigen::AlignedBox3d box = {};  // m, in its axes

  double distance(const Vec3& p, double reach) const {
    if ((box.min() - p).cwiseMax(p - box.max()).cwiseMax(0).norm() > reach) return reach;
    double best = reach;
    for (const Convex& piece : pieces)
      best = std::min(best,
                      distance_to(piece.shape, piece.faces, piece.at.rotation.transpose() * (p - piece.at.position)));
    if (!mesh) return best;
    const bool within = mesh->box().contains(p) && inside(*mesh, p);
    double surface = within ? box.sizes().norm() : best;
    if (const auto found = collision::nearest(*mesh, p, surface)) surface = found->distance;
    return std::min(best, within ? -surface : surface);
  }
};

Depth::Depth(const Surroundings& surroundings) {
  for (const Object& object : surroundings.objects) {
    Volume volume{.pose = object.pose, .mesh = object.loose() ? nullptr : object.mesh, .pieces = {}};
    if (volume.mesh) volume.box = volume.mesh->box();
    for (const Object::Piece& piece : object.pieces) {
      const bool hull = piece.shape.core() == Core::hull;
      volume.pieces.push_back(
          {piece.shape, piece.at, hull ? hull_faces(piece.shape.corners()) : std::vector<HullFace>()});
      const Vec3 room = Vec3::Constant(piece.shape.radius());
      for (const Vec3& corner : piece.shape.corners())
        volume.box.extend({piece.at * corner - room, piece.at * corner + room});
    }
    volumes_.push_back(std::move(volume));
  }
}
Depth::~Depth() = default;

double Depth::distance(const Vec3& point, std::size_t object, double reach, PoseSpan poses) const {
  const Pose<double>& pose = poses.empty() ? volumes_[object].pose : poses[object];
  return volumes_[object].distance(pose.rotation.transpose() * (point - pose.position), reach);
}

double Depth::distance(const Vec3& point, double reach) const {
  for (std::size_t k = 0; k < volumes_.size(); ++k) reach = std::min(reach, distance(point, k, reach));
  return reach;
}

double Depth::of(const hand::Poses& hand, std::span<const Ball> balls, double reach, PoseSpan poses) const {
  double deepest = -reach;
  for (const Ball& ball : balls) {
    const Vec3 p = hand[at(ball.body)] * ball.at;
    for (std::size_t k = 0; k < volumes_.size(); ++k) {
      const double near = std::max(1e-9, ball.radius - deepest), gap = distance(p, k, near, poses);
      if (gap < near) deepest = std::max(deepest, ball.radius - gap);
    }
  }
  return deepest;
}

std::vector<Ball> balls(const hand::Model& model) {
  std::vector<Ball> out;
  const std::vector<Shape> shapes = hand::shapes(model);
  for (int body = 0; body < hand::bodies; ++body) {
    const Shape& shape = shapes[at(body)];
    // The balls' centres lie where one of the greatest radius fits.
    const Vec3& half = shape.half();
    const double inner = shape.core() == Core::box ? half.minCoeff() : 0;
    const Vec3 room = half - Vec3::Constant(inner).cwiseMin(half);
    const auto along = [&](Index k) { return room[k] > 1e-9 ? 2 : 0; };  // steps to each side
    for (int i = -along(0); i <= along(0); ++i)
      for (int j = -along(1); j <= along(1); ++j)
        for (int k = -along(2); k <= along(2); ++k)
          out.push_back({body, Vec3(i, j, k).cwiseProduct(room) / 2, shape.radius() + inner});
    if (shape.core() == Core::box)
      for (const Vec3& corner : shape.corners()) out.push_back({body, corner, shape.radius()});
  }
  return out;
}

}  // namespace zwang::god
