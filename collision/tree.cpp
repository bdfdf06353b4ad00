#include <zwang/collision/tree.h>

#include <fcl/geometry/bvh/BVH_model.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <zwang/collision/halves.h>
#include <zwang/core/problem/mix_bits.h>

namespace zwang::collision {
namespace {

using Model = fcl::BVHModel<fcl::AABB<double>>;

float down(double x) {
  const auto f = static_cast<float>(x);
  return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float up(double x) { return -down(-x); }

void build(const Mesh& mesh, Model& model) {
  // FCL's triangles hold size_t; it copies both lists.
  const auto triangles = mapped(mesh.triangles, [](const auto& t) { return fcl::Triangle(t[0], t[1], t[2]); });
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  model.addSubModel(mesh.vertices, triangles);
  if (model.endModel() != fcl::BVH_OK) throw std::runtime_error("FCL could not build a tree");
}

constexpr std::uint64_t magic = 0x3565657274677a0au;  // "\nzgtree5" where bytes run from low to high

// By words, as trees are large.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0;
  for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), 8);
    hash = mix_bits(hash ^ word);
  }
  return fnv1a(bytes, hash);
}

struct Header {
  std::uint64_t checksum;  // of all that follows it
  std::uint64_t magic, nodes, triangles, points, of_slivers;
};

}  // namespace

Tree::Tree(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw std::invalid_argument("a tree of no triangles");
  if (mesh.triangles.size() > (std::size_t{1} << 28)) throw std::invalid_argument("more than 2^28 triangles");
  of_slivers_ = mostly_slivers(mesh);
  if (of_slivers_) {
    flatten(mesh, Halves(mesh));
  } else {
    Model model;
    build(mesh, model);
    flatten(mesh, model);
  }
  find_box();
  find_slabs();
}

template <class Boxes>
void Tree::flatten(const Mesh& mesh, const Boxes& model) {
  corners_.reserve(mesh.triangles.size());
  origin_.reserve(mesh.triangles.size());
  std::vector<std::uint32_t> of_leaf;  // vertices of the mesh whose points are in the leaf at hand
  const auto take = [&](int id) {
    const auto first = static_cast<std::uint32_t>(points_.size() - of_leaf.size());
    auto& mine = corners_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[static_cast<std::size_t>(id)][k];
      const auto at = std::find(of_leaf.begin(), of_leaf.end(), vertex);
      mine[k] = first + static_cast<std::uint32_t>(at - of_leaf.begin());
      if (at != of_leaf.end()) continue;
      of_leaf.push_back(vertex);
      points_.push_back(mesh.vertices[vertex]);
    }
    origin_.push_back(static_cast<std::uint32_t>(id));
  };
  // An explicit stack: the tree of a mesh whose triangles share their centres is as deep as the number of triangles.
  std::vector<int> below;
  const auto take_all = [&](int top) {
    const std::size_t base = below.size();
    for (below.push_back(top); below.size() > base;) {
      const auto& node = model.getBV(below.back());
      below.pop_back();
      if (node.isLeaf()) {
        take(node.primitiveId());
      } else {
        below.push_back(node.rightChild());
        below.push_back(node.leftChild());
      }
    }
  };

  nodes_.clear();
  std::vector<std::pair<int, std::size_t>> open{{0, 0}};  // FCL's node, or -1 and the flat node whose subtree ends here
  while (!open.empty()) {
    const auto [id, flat] = open.back();
    open.pop_back();
    if (id < 0) {
      nodes_[flat].skip = static_cast<std::uint32_t>(nodes_.size());
      continue;
    }
    const auto& node = model.getBV(id);
    TreeNode mine{{}, {}, 0, size()};
    for (int k = 0; k < 3; ++k) {
      mine.low[static_cast<std::size_t>(k)] = down(node.bv.min_[k]);
      mine.high[static_cast<std::size_t>(k)] = up(node.bv.max_[k]);
    }
    if (node.num_primitives <= leaf_size || node.isLeaf()) {
      of_leaf.clear();
      take_all(id);
      mine.skip = static_cast<std::uint32_t>(nodes_.size() + 1);
      nodes_.push_back(mine);
    } else {
      open.emplace_back(-1, nodes_.size());
      open.emplace_back(node.rightChild(), 0);
      open.emplace_back(node.leftChild(), 0);
      nodes_.push_back(mine);
    }
  }
  nodes_.push_back({{}, {}, 0, size()});
  nodes_.shrink_to_fit();
  points_.shrink_to_fit();
}

void Tree::find_box() {
  box_.setEmpty();
  for (const Vec3& p : points_) box_.extend(p);
}

// Where it has a small part of the surface of the box along the axes.
void Tree::find_slabs() {
  constexpr std::uint32_t most = 64;  // triangles; above that what is not of slivers is no strip any more
  constexpr double small = 0.2;
  const auto surface = [](const Vec3& w) { return w.x() * w.y() + w.y() * w.z() + w.z() * w.x(); };
  for (std::size_t k = 0; k < nodes().size(); ++k) {
    const auto [begin, end] = range(k);
    if (end - begin > most && !of_slivers_) continue;
    const TreeNode& n = nodes_[k];
    const Slab slab = slab_about(k);
    if (surface(slab.high - slab.low) >
        small * surface({n.high[0] - n.low[0], n.high[1] - n.low[1], n.high[2] - n.low[2]}))
      continue;
    if (slabs_.empty()) slab_at_.assign(nodes().size(), no_slab);
    slab_at_[k] = static_cast<std::uint32_t>(slabs_.size());
    slabs_.push_back(slab);
  }
  slabs_.shrink_to_fit();
}

Slab Tree::slab_about(std::size_t node) const {
  constexpr double rounding = 1e-12;  // m
  Vec3 along = Vec3::Zero(), across = Vec3::Zero();
  const auto [begin, end] = range(node);
  for (const Triangle& t : triangles(begin, end)) {
    const auto& [a, b, c] = t.corner;
    for (const Vec3& edge : {Vec3(b - a), Vec3(c - b), Vec3(a - c)})
      if (edge.squaredNorm() > along.squaredNorm()) along = edge;
    const Vec3 normal = (b - a).cross(c - a);
    across += normal.dot(across) < 0 ? -normal : normal;
  }
  Mat3 axes;
  axes.col(0) = along.normalized();
  across -= across.dot(axes.col(0)) * axes.col(0);
  axes.col(2) = across.squaredNorm() > 0 ? across.normalized() : axes.col(0).unitOrthogonal();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points(begin, end)) box.extend(axes.transpose() * p);
  return {axes, box.min() - Vec3::Constant(rounding), box.max() + Vec3::Constant(rounding)};
}

double Tree::bytes_per_triangle() const {
  const std::size_t bytes = nodes_.size() * sizeof(TreeNode) + points_.size() * sizeof(Vec3) +
                            corners_.size() * (sizeof(corners_[0]) + sizeof(origin_[0])) +
                            slabs_.size() * sizeof(Slab) + slab_at_.size() * sizeof(slab_at_[0]);
  return static_cast<double>(bytes) / size();
}

std::string Tree::to_bytes() const {
  Header header{0, magic, nodes_.size(), corners_.size(), points_.size(), of_slivers_};
  std::string bytes(sizeof header, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  const auto put = [&bytes](const auto& list) {
    bytes.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(list[0]));
  };
  put(nodes_);
  put(points_);
  put(corners_);
  put(origin_);
  header.checksum = checksum(std::string_view(bytes).substr(sizeof header.checksum));
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

Tree Tree::from_bytes(std::string_view bytes) {
  Header header{};
  if (bytes.size() > sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != magic || header.points == 0 || checksum(bytes.substr(sizeof header.checksum)) != header.checksum)
    throw std::runtime_error("not a whole tree of this version");
  bytes.remove_prefix(sizeof header);
  Tree tree;
  tree.of_slivers_ = header.of_slivers != 0;
  const auto get = [&bytes](auto& list, std::size_t count) {
    list.resize(count);
    std::memcpy(static_cast<void*>(list.data()), bytes.data(), count * sizeof(list[0]));
    bytes.remove_prefix(count * sizeof(list[0]));
  };
  get(tree.nodes_, header.nodes);
  get(tree.points_, header.points);
  get(tree.corners_, header.triangles);
  get(tree.origin_, header.triangles);
  tree.find_box();
  tree.find_slabs();
  return tree;
}

}  // namespace zwang::collision
