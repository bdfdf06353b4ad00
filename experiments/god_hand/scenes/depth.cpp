#include <zwang/experiments/god_hand/scenes/depth.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <zwang/bench/collision/hand_shapes.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/collision/narrow_phase/closest.h>

namespace zwang::god {

// A half space that holds a hull: normal . p <= offset.
struct HullFace {
  Vec3 normal;
  double offset;
};

namespace {

using collision::Core;
using collision::Shape;
using collision::Tree;
using collision::TreeNode;

// Every plane through three corners that has all others on one side. Corners are at most 64. A flat hull has its own
// plane from both sides, and no inside.
std::vector<HullFace> faces_of(std::span<const Vec3> corners) {
  std::vector<HullFace> faces;
  double size = 0;
  for (const Vec3& p : corners) size = std::max(size, (p - corners[0]).norm());
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const Vec3 n = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
        if (n.norm() <= 1e-10 * size * size) continue;
        for (const Vec3& normal : {Vec3(n.normalized()), Vec3(-n.normalized())}) {
          const double offset = normal.dot(corners[i]);
          if (std::all_of(corners.begin(), corners.end(),
                          [&](const Vec3& p) { return normal.dot(p) <= offset + 1e-9 * size; }))
            faces.push_back({normal, offset});
        }
      }
  return faces;
}

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

double distance2(const TreeNode& node, const Vec3& p) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[static_cast<Index>(k)];
    const double d = std::max({0.0, static_cast<double>(node.low[k]) - x, x - static_cast<double>(node.high[k])});
    sum += d * d;
  }
  return sum;
}

// The nearest triangle, nearer child first.
void nearest(const Tree& tree, std::size_t at, const Vec3& p, double& best) {
  static const Shape point = Shape::sphere(1);
  if (tree.leaf(at)) {
    for (const collision::Triangle& t : tree.triangles(tree.range(at)))
      best = std::min(best, closest(point, {{t.corner[0] - p, t.corner[1] - p, t.corner[2] - p}}, best).distance);
    return;
  }
  std::array<std::size_t, 2> child{at + 1, tree.nodes()[at + 1].skip};
  std::array<double, 2> far{distance2(tree.nodes()[child[0]], p), distance2(tree.nodes()[child[1]], p)};
  if (far[1] < far[0]) std::swap(child[0], child[1]), std::swap(far[0], far[1]);
  for (std::size_t k = 0; k < 2; ++k)
    if (far[k] < best * best) nearest(tree, child[k], p, best);
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
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;  // m, in its axes

  double distance(const Vec3& p, double reach) const {
    if ((low - p).cwiseMax(p - high).cwiseMax(0).norm() > reach) return reach;
    double best = reach;
    for (const Convex& piece : pieces)
      best = std::min(best,
                      distance_to(piece.shape, piece.faces, piece.at.rotation.transpose() * (p - piece.at.position)));
    if (!mesh) return best;
    const bool within =
        (p.array() >= mesh->low().array()).all() && (p.array() <= mesh->high().array()).all() && inside(*mesh, p);
    double surface = within ? (high - low).norm() : best;
    nearest(*mesh, 0, p, surface);
    return std::min(best, within ? -surface : surface);
  }
};

Depth::Depth(const Surroundings& surroundings) {
  for (const Object& object : surroundings.objects) {
    Volume volume{.pose = object.pose, .mesh = object.loose() ? nullptr : object.mesh, .pieces = {}};
    if (volume.mesh) {
      volume.low = volume.mesh->low();
      volume.high = volume.mesh->high();
    }
    for (const Object::Piece& piece : object.pieces) {
      const bool hull = piece.shape.core() == Core::hull;
      volume.pieces.push_back(
          {piece.shape, piece.at, hull ? faces_of(piece.shape.corners()) : std::vector<HullFace>()});
      for (const Vec3& corner : piece.shape.corners()) {
        const Vec3 p = piece.at * corner;
        volume.low = volume.low.cwiseMin(p - Vec3::Constant(piece.shape.radius()));
        volume.high = volume.high.cwiseMax(p + Vec3::Constant(piece.shape.radius()));
      }
    }
    volumes_.push_back(std::move(volume));
  }
}
Depth::~Depth() = default;
Depth::Depth(Depth&&) noexcept = default;

double Depth::distance(const Vec3& point, std::size_t object, double reach, std::span<const Pose<double>> poses) const {
  const Pose<double>& pose = poses.empty() ? volumes_[object].pose : poses[object];
  return volumes_[object].distance(pose.rotation.transpose() * (point - pose.position), reach);
}

double Depth::distance(const Vec3& point, double reach, std::span<const Pose<double>> poses) const {
  for (std::size_t k = 0; k < volumes_.size(); ++k) reach = std::min(reach, distance(point, k, reach, poses));
  return reach;
}

Depth::Deepest Depth::of(const hand::Poses& hand, std::span<const Ball> balls, double reach,
                         std::span<const Pose<double>> poses) const {
  Deepest out{.depth = -reach};
  for (const Ball& ball : balls) {
    const Vec3 p = hand[static_cast<std::size_t>(ball.body)] * ball.at;
    for (std::size_t k = 0; k < volumes_.size(); ++k) {
      const double near = std::max(1e-9, ball.radius - out.depth), gap = distance(p, k, near, poses);
      if (gap < near && ball.radius - gap > out.depth) out = {ball.radius - gap, ball.body, static_cast<int>(k)};
    }
  }
  return out;
}

std::vector<Ball> balls(const hand::Model& model) {
  std::vector<Ball> out;
  const std::vector<Shape> shapes = hand::shapes(model);
  for (int body = 0; body < hand::bodies; ++body) {
    const Shape& shape = shapes[static_cast<std::size_t>(body)];
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
