#pragma once

#include <vector>

#include <zwang/collision/mesh.h>

namespace zwang::collision {

// A tree of boxes over the triangles of a mesh, halved by their centres along the axis in which those lie farthest
// apart. FCL splits the longest side of the box instead: of slivers side by side that is the side along them, in which
// their centres are the same, and neighbours end in different halves. Read like fcl::BVHModel<fcl::AABB>.
class Halves {
 public:
  explicit Halves(const Mesh& mesh);

  struct Node {
    struct {
      Vec3 min_, max_;
    } bv;
    int num_primitives, first;  // a leaf's triangle, or an inner node's first child; the other one follows it
    bool isLeaf() const { return num_primitives == 1; }
    int primitiveId() const { return first; }
    int leftChild() const { return first; }
    int rightChild() const { return first + 1; }
  };
  const Node& getBV(int node) const { return nodes_[at(node)]; }

 private:
  std::vector<Node> nodes_ = {};
};

// Are a quarter of the triangles or more longer than 20 times their height?
bool mostly_slivers(const Mesh& mesh);

}  // namespace zwang::collision
