#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/body_rows.h"

namespace zwang {

// The null space of the equality rows of jointed bodies, from one pass over the joint graph in each direction.
//
// A spanning tree gives each body b but the roots one joint, C y_b + D y_p = h, to its parent p. An orthogonal
// factorization of its six columns gives its free directions Z and
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
// Rows that close loops are not part of the tree: `cut` lists them. factorize() refuses, with the reason, joints whose
// rows are nearly dependent (the decision which of them count needs the careful path of equality_elimination.h).
class JointTree {
 public:
  using Lanes = BodyRows::Lanes;
  using Block = BodyRows::Block;
  using Rows = Block;                                           // column i is row i of a 6 x 6 block
  using Motion = Mat<double, BodyRows::lanes, Eigen::Dynamic>;  // lanes x bodies

  bool factorize(const BodyRows& rows);
  std::string_view reason() const { return reason_; }  // why factorize() refused

  Index freedom() const { return freedom_; }
  std::span<const Index> tree_rows() const { return tree_rows_; }  // of BodyRows, in the order of mu below
  std::span<const Index> cut() const { return cut_; }              // of BodyRows
  double smallest_pivot() const { return smallest_pivot_; }
  double pivot_of(Index position) const { return pivot_[position]; }

  // Nt: padded x 6 bodies, column 6 b + i is row i of body b in N; padded is a multiple of 8.
  void null_space(Matrix& Nt) const;
  // v = N'y and y = N v; v of length freedom().
  void reduce(const Motion& y, Vector& v) const;
  void expand(const Vector& v, Motion& y) const;
  // The least-length y with G_E y = sigma over the tree rows.
  void shift(const Vector& sigma, Motion& y) const;
  // mu with G_E' mu = t, for t in the range of G_E'.
  void multipliers(const Motion& t, Vector& mu) const;

 private:
  struct Joint {
    int body = -1, parent = -1;      // parent -1: the world, or none for a floating root
    Index first = 0, count = 0;      // tree rows
    Index column = 0, freedom = 0;   // of N
    std::vector<int> children = {};  // positions in joints_
    Block C_inverse = Block::Zero(), F = Block::Zero(), P = Block::Zero();  // by columns
    Rows F_rows, R, S;  // by rows; of S the first `freedom` are void
  };
  struct Edge {
    int a = 0, b = -1;
    Index first = 0, count = 0;  // of sorted_
  };

  bool build_topology(const BodyRows& rows);
  void accumulate(Joint& joint);
  bool eliminate(const BodyRows& rows, Joint& joint);
  bool refuse(std::string_view why) {
    reason_ = why;
    return false;
  }

  std::vector<Joint> joints_;  // parents before children
  std::vector<Index> tree_rows_, cut_, sorted_;
  std::vector<double*> below_;
  std::vector<Edge> edges_;
  std::vector<std::vector<int>> edges_of_;  // a body; the last entry is the world's
  std::vector<int> joint_of_;               // a body
  std::vector<std::array<int, 2>> known_;   // the graph that the topology was built for
  std::vector<Index> known_rows_;
  Index known_bodies_ = -1;
  Index freedom_ = 0;
  double smallest_pivot_ = 1;
  Vector pivot_;
  mutable Vector v_;
  mutable Motion rest_;
  std::string_view reason_;
};

}  // namespace zwang
