#pragma once

#include <string_view>
#include <vector>

#include <zwang/solvers/form/joint_graph.h>

namespace zwang {

// The null space of the equality rows of jointed bodies, from one pass over the joint graph in each direction.
//
// A spanning tree (joint_graph.h) gives each body b but the roots one joint, C y_b + D y_p = h, to its parent p. An
// orthogonal factorization of its six columns gives its free directions Z and
//
//   y_b = C^+ h + X y_p + Z q,   X = -C^+ D.
//
// Backward, R_b (6 x 6) measures what moving b costs with everything beyond it: |R_b y_b| is the least length of the
// whole subtree that follows (Featherstone's articulated-body inertia, 1983, here as an orthogonal factor: R'R is never
// formed). With R_b Z = Q_z T and B = Q_z' R_b X the least-length motion is q = -T^-1 B y_p + T^-1 v_b, so
//
//   y_b = F y_p + P v_b,   F = X - Z T^-1 B,   P = Z T^-1,
//
// v_b being the joint's own coordinates. Forward, these products are the columns of N: an orthonormal basis, G_E N = 0,
// of 6 columns a floating root and 6 - rank a joint; a row of a body meets the columns of its ancestors only.
//
// Joints that do not wait for each other (the same phalanx of several fingers) are eliminated together, one a lane of a
// vector of the processor: roots and quotients, which wait for each other twelve times a joint, then do so once for all
// of them. Two vectors at a time were tried: fewer steps, each of which passes through memory.
//
// factorize() refuses, with the reason, joints whose rows are nearly dependent (the decision which of them count needs
// the careful path of equality_elimination.h).
class JointTree {
 public:
  using Block = BodyRows::Block;
  using Motion = BodyRows::Motion;

  std::string_view factorize(const BodyRows& rows);  // "" or why it refuses

  Index freedom() const { return graph_.freedom(); }
  const std::vector<Index>& tree_rows() const { return graph_.tree_rows(); }  // of BodyRows, in the order of mu below
  const std::vector<Index>& cut() const { return graph_.cut(); }              // of BodyRows: rows that close loops
  double smallest_pivot() const { return smallest_pivot_; }

  using Lanes = BodyRows::Lanes;

  // Nt: padded x 6 bodies, column 6 b + i is row i of body b in N; padded is a multiple of 8.
  void null_space(Matrix& Nt) const;
  // N'g += of a row's parts on one body or two (the second -1): what null_space() would give, for a few rows cheaper.
  void add_reduced(const std::array<int, 2>& body, Lanes own, Lanes other, double* v) const;
  // v = N'y and y = N v; v of length freedom().
  void reduce(const Motion& y, Vector& v) const { backward(coordinates, y, v); }
  void expand(const Vector& v, Motion& y) const { forward(coordinates, v, y); }
  // A y with G_E y = sigma over the tree rows, and the least-length one.
  void meet(const Vector& sigma, Motion& y) const { forward(constraints, sigma, y); }
  void shift(const Vector& sigma, Motion& y) const;
  // mu with G_E' mu = t, for t in the range of G_E'.
  void multipliers(const Motion& t, Vector& mu) const { backward(constraints, t, mu); }

 private:
  // Of a joint: C^+, F and P by columns; F and S = (B without its first `freedom` rows) by rows.
  struct alignas(64) Blocks {
    Block C_inverse, F, P, F_rows, S;
    Blocks() {}  // no zeros: what is read was written
  };

  // What a joint has of its own: columns, and where their entries stand in a vector.
  struct Own {
    Block Blocks::* columns;
    Index JointGraph::Joint::*first, JointGraph::Joint::*count;
  };
  static constexpr Own coordinates{&Blocks::P, &JointGraph::Joint::column, &JointGraph::Joint::freedom};
  static constexpr Own constraints{&Blocks::C_inverse, &JointGraph::Joint::first, &JointGraph::Joint::count};
  void forward(const Own& own, const Vector& x, Motion& y) const;
  void backward(const Own& own, const Motion& y, Vector& x) const;

  // Scalar: double for one joint, a vector of the processor for a group.
  template <class Scalar>
  std::string_view eliminate(const BodyRows& rows, std::span<const int> group);
  template <class Scalar>
  bool accumulate(std::span<const int> group, std::array<std::array<Scalar, 6>, 6>& R);
  const JointGraph::Joint& joint(int position) const { return graph_.joints()[at(position)]; }

  JointGraph graph_;
  std::vector<Blocks> blocks_;  // of the graph's joints, and one to spare
  double smallest_pivot_ = 1;
  mutable Vector v_;
  mutable Motion rest_;
};

}  // namespace zwang
