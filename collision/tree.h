#pragma once

#include <array>
#include <span>
#include <string>

#include "collision/mesh.h"

namespace zwang::collision {

struct Triangle {
  std::array<Vec3, 3> corner;  // m, in the mesh's axes
};

// An axis-aligned box in single precision, rounded outward, and where the walk goes on. Nodes lie in the order of a
// depth-first walk: an inner node's first child is the next node, `skip` the next one outside its subtree. A walk needs
// no stack.
struct TreeNode {
  std::array<float, 3> low, high;
  std::uint32_t skip;
  std::uint32_t leaf;  // first triangle * 8 + number of triangles; 0: inner node
};
static_assert(sizeof(TreeNode) == 32);

// The triangles of a mesh in the order of the leaves of a tree of boxes. Built by fcl::BVHModel<AABB> and flattened;
// small subtrees become one leaf. 72 + 4 bytes a triangle and about 20 of nodes.
class Tree {
 public:
  Tree() = default;
  // Throws std::invalid_argument for a mesh without triangles or with more than 2^28.
  explicit Tree(const Mesh& mesh);

  std::span<const TreeNode> nodes() const { return nodes_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  // The triangles of a node's subtree, first and end: they lie together.
  std::pair<std::uint32_t, std::uint32_t> range(std::size_t node) const {
    const auto first = [this](std::size_t n) {
      while (n < nodes_.size() && nodes_[n].leaf == 0) ++n;
      return n < nodes_.size() ? nodes_[n].leaf / 8 : static_cast<std::uint32_t>(triangles_.size());
    };
    return {first(node), first(nodes_[node].skip)};
  }
  // Where triangle t of this tree stood in the mesh.
  std::uint32_t origin(std::size_t t) const { return origin_[t]; }
  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }
  double bytes_per_triangle() const;

  // One block of bytes that from_bytes gives back bit for bit. from_bytes throws std::runtime_error when the block is
  // torn, changed or of another version or byte order.
  std::string to_bytes() const;
  static Tree from_bytes(std::string_view bytes);

 private:
  std::vector<TreeNode> nodes_ = {};
  std::vector<Triangle> triangles_ = {};
  std::vector<std::uint32_t> origin_ = {};
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
};

}  // namespace zwang::collision
