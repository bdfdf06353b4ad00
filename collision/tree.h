#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <ranges>
#include <span>
#include <string>

#include <zwang/collision/mesh.h>

namespace zwang::collision {

struct Triangle {
  std::array<Vec3, 3> corner;  // m, in the mesh's axes
};

// An axis-aligned box in single precision, rounded outward. Nodes are stored in depth-first order: an inner node's
// first child is the next node, and `skip` is the next node outside its subtree. A walk needs no stack.
struct TreeNode {
  std::array<float, 3> low, high;
  std::uint32_t skip;
  std::uint32_t first;  // triangle of its subtree

  // Its greatest coordinate along `up`.
  double height(const Vec3& up) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += up[static_cast<Index>(k)] * (up[static_cast<Index>(k)] > 0 ? high : low)[k];
    return sum;
  }
  Vec3 nearest(const Vec3& p) const {
    return Vec3(std::clamp<double>(p.x(), low[0], high[0]), std::clamp<double>(p.y(), low[1], high[1]),
                std::clamp<double>(p.z(), low[2], high[2]));
  }
  // Its second longest side.
  double width() const {
    std::array side{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    std::ranges::sort(side);
    return side[1];
  }
  // From p to the box, squared.
  double distance2(const Vec3& p) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = p[static_cast<Index>(k)];
      const double out = std::max({static_cast<double>(low[k]) - x, x - static_cast<double>(high[k]), 0.0});
      sum += out * out;
    }
    return sum;
  }
};
static_assert(sizeof(TreeNode) == 32);

// An oblique box about the triangles of a subtree. Slivers side by side that run across the axes have boxes along the
// axes as long as the part in two or three directions, each of which overlaps hundreds of others; these hardly do.
struct Slab {
  Mat3 axes;       // columns: unit vectors, the first along the longest edge, the last across the surface
  Vec3 low, high;  // m, along the axes, rounded outward

  // From p to the box, squared.
  double distance2(const Vec3& p) const {
    const Vec3 at = axes.transpose() * p;
    return (low - at).cwiseMax(at - high).cwiseMax(0).squaredNorm();
  }
};

// The triangles of a mesh in the order of the leaves of a tree of boxes. Built by fcl::BVHModel<AABB>, of slivers
// by Halves, and flattened; small subtrees become one leaf. Corners are stored once per leaf, in the order of the
// leaves, so the points of a subtree are contiguous. Queries are limited by memory, and three corners per triangle
// would be twice as many. (CGAL's AABB_tree would be a second tree of each mesh, neither flat nor storable.)
class Tree {
 public:
  static constexpr int leaf_size = 4;  // triangles; with fewer a box costs as much as the tests it may save

  Tree() = default;
  // Throws std::invalid_argument for a mesh without triangles or with more than 2^28.
  explicit Tree(const Mesh& mesh);

  std::span<const TreeNode> nodes() const { return std::span(nodes_).first(nodes_.size() - 1); }
  bool leaf(std::size_t node) const { return nodes_[node].skip == node + 1; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(corners_.size()); }
  Triangle triangle(std::size_t t) const {
    const auto& [a, b, c] = corners_[t];
    return {points_[a], points_[b], points_[c]};
  }
  // A range of all of them, or of those from `first` on to `end`.
  auto triangles(std::uint32_t first, std::uint32_t end) const {
    return std::views::iota(first, end) | std::views::transform([this](std::uint32_t t) { return triangle(t); });
  }
  auto triangles() const { return triangles(0, size()); }
  auto triangles(std::pair<std::uint32_t, std::uint32_t> range) const { return triangles(range.first, range.second); }
  // The triangles of a node's subtree, first and end: they are contiguous.
  std::pair<std::uint32_t, std::uint32_t> range(std::size_t node) const {
    return {nodes_[node].first, nodes_[nodes_[node].skip].first};
  }
  // Of a subtree of slivers; null for most.
  const Slab* slab(std::size_t node) const {
    return slabs_.empty() || slab_at_[node] == no_slab ? nullptr : &slabs_[slab_at_[node]];
  }
  bool of_slivers() const { return of_slivers_; }
  // The point nearest to p of a node's box, oblique where it has one.
  Vec3 nearest(std::size_t node, const Vec3& p) const {
    if (const Slab* box = slab(node))
      return box->axes * (box->axes.transpose() * p).cwiseMax(box->low).cwiseMin(box->high);
    return nodes_[node].nearest(p);
  }
  // The greatest coordinate along `up` of that box.
  double height(std::size_t node, const Vec3& up) const {
    const Slab* box = slab(node);
    if (box == nullptr) return nodes_[node].height(up);
    const Vec3 n = box->axes.transpose() * up;
    return n.cwiseProduct(box->low).cwiseMax(n.cwiseProduct(box->high)).sum();
  }
  // Depth first: `enter(node, number)` decides whether a node's subtree is visited, `visit(first, end)` gets the
  // triangles of each leaf that was entered.
  template <class Enter, class Visit>
  void walk(Enter enter, Visit visit) const {
    for (std::size_t i = 0; i < nodes().size();) {
      if (!enter(nodes_[i], i)) {
        i = nodes_[i].skip;
        continue;
      }
      if (leaf(i)) visit(nodes_[i].first, nodes_[i + 1].first);
      ++i;
    }
  }
  // The corners of such a subtree; `corners` counts from the first of them on.
  std::span<const Vec3> points(std::uint32_t first, std::uint32_t end) const {
    const std::size_t begin = corners_[first][0], stop = end < size() ? corners_[end][0] : points_.size();
    return {points_.data() + begin, stop - begin};
  }
  std::span<const std::array<std::uint32_t, 3>> corners() const { return corners_; }
  // The number of triangle t of this tree in the mesh.
  std::uint32_t origin(std::size_t t) const { return origin_[t]; }
  const Eigen::AlignedBox3d& box() const { return box_; }
  double bytes_per_triangle() const;

  // One block of bytes, from which from_bytes restores the tree bit for bit. from_bytes throws std::runtime_error when
  // the block is truncated, changed or of another version or byte order.
  std::string to_bytes() const;
  static Tree from_bytes(std::string_view bytes);

 private:
  static constexpr std::uint32_t no_slab = ~std::uint32_t{0};

  template <class Boxes>
  void flatten(const Mesh& mesh, const Boxes& boxes);
  void find_box();
  void find_slabs();
  Slab slab_about(std::size_t node) const;

  std::vector<TreeNode> nodes_ = {TreeNode{}};  // and one after the last, whose first triangle is size()
  std::vector<Vec3> points_ = {};
  std::vector<std::array<std::uint32_t, 3>> corners_ = {};  // of each triangle, in points_
  std::vector<std::uint32_t> origin_ = {};
  std::vector<Slab> slabs_ = {};
  std::vector<std::uint32_t> slab_at_ = {};  // by node; empty where there are none
  Eigen::AlignedBox3d box_{Vec3::Zero(), Vec3::Zero()};
  bool of_slivers_ = false;  // mostly (halves.h)
};

}  // namespace zwang::collision
