#pragma once

#include <array>
#include <span>
#include <vector>

#include <zwang/solvers/form/body_rows.h>

namespace zwang {

// A spanning tree of the bodies that equality rows connect, kept as long as the rows connect the same bodies. Another
// one of no more bodies and rows is built in the same storage.
//
// All rows between the same two bodies are one joint. The tree begins at the world, then at the body with the most
// joints of what is left; breadth first. Rows of joints outside the tree close loops: `cut` lists them.
class JointGraph {
 public:
  struct Joint {
    int body = -1, parent = -1;     // parent -1: the world, or none for a floating root
    Index first = 0, count = 0;     // of tree_rows
    Index column = 0, freedom = 0;  // of the null space: 6 - count, at least 0
    int first_child = 0;            // position in joints(); the others follow it
    int children = 0;
  };

  void build(const BodyRows& rows);
  // A number that tells problems apart whose equality rows connect other bodies, or in another order.
  static Index kind(const Problem& problem);

  const std::vector<Joint>& joints() const { return joints_; }        // parents before children
  const std::vector<Index>& tree_rows() const { return tree_rows_; }  // of BodyRows
  const std::vector<Index>& cut() const { return cut_; }              // of BodyRows
  int position_of(int body) const { return position_[at(body)]; }     // in joints()
  Index freedom() const { return freedom_; }
  // Joints of as many rows, as many together as the processor's vectors hold, children before parents: none of them
  // waits for another.
  std::size_t groups() const { return group_end_.size(); }
  std::span<const int> group(std::size_t g) const {
    const std::size_t begin = g > 0 ? group_end_[g - 1] : 0;
    return {order_.data() + begin, group_end_[g] - begin};
  }

 private:
  struct Edge {
    int a = 0, b = -1;           // the world is the number of bodies
    Index first = 0, count = 0;  // of sorted_
  };

  bool is_known(const BodyRows& rows) const;
  void reserve(std::size_t bodies, std::size_t rows);
  void find_edges(const BodyRows& rows);
  std::span<const int> edges_of(int body) const {
    const auto b = at(body);
    return std::span(edges_of_).subspan(at(edge_begin_[b]), at(edge_begin_[b + 1] - edge_begin_[b]));
  }
  void span(int world);
  void group_joints();

  std::vector<Joint> joints_;
  std::vector<Index> tree_rows_, cut_, sorted_;
  std::vector<Edge> edges_;
  std::vector<int> edges_of_, edge_begin_;   // of one body after the other, the world last; where each begins
  std::vector<char> reached_, used_, done_;  // of a body or the world; of an edge; of a joint
  std::vector<int> order_;                   // positions in joints_
  std::vector<int> height_;                  // of a joint above the tips
  std::vector<int> position_;                // of a body, in joints_
  std::vector<std::size_t> group_end_;
  std::vector<std::array<int, 2>> known_;  // what the graph was built for
  std::vector<Index> known_rows_;
  Index known_bodies_ = -1, freedom_ = 0;
};

}  // namespace zwang
