#pragma once

#include <string_view>
#include <vector>

#include <zwang/core/problem/sparsity_pattern.h>
#include <zwang/solvers/form/body_rows.h>
#include <zwang/solvers/form/joint_tree.h>

namespace zwang {

// Gauss' problem with its equality rows gone: y = y_E + N v turns unit rows into
//
//   minimize 1/2 |v|^2   subject to  (G_I N) v >= h_I - G_I y_E
//
// in the few unknowns that the joints leave: 26 for a hand of 96. N comes from the joint graph (joint_tree.h), found in
// J itself; the rows that close its loops are projected out of it by a dense orthogonal factorization. What is neither
// is refused with the reason, for a path that decides ranks row by row (equality_elimination.h). The graph is kept
// between frames and searched again only when the rows change.
class NullSpaceForm {
 public:
  using Motion = JointTree::Motion;  // lanes x bodies: y by body

  std::string_view build(const Problem& problem);  // "" or why it refuses
  // For who may want it again: remember() what it was built for; does it serve this problem, of the same M and J? Then
  // it is to the bit what build() makes, less what z_u and c say (shift() does), and perhaps of more rows: inequality
  // rows that by c = -Inf are none any more.
  void remember(const Problem& problem);
  bool take(const Problem& problem);

  const BodyRows& rows() const { return rows_; }
  Index freedom() const { return freedom_; }
  const std::vector<Index>& equalities() const { return equalities_; }      // of rows(), in the order of mu_E
  const std::vector<Index>& inequalities() const { return inequalities_; }  // of rows()
  const Motion& y_E() const { return y_E_; }
  double smallest_pivot() const { return smallest_pivot_; }
  // y_E of other h, by rows of the problem that are not of unit length yet; and all of it `by` as long.
  void shift(const Vector& h);
  void stretch(double by) { y_E_ *= by; }

  // N'g_i into the first freedom() entries of a padded column, zeros behind: for many rows after form_basis().
  void form_basis();
  void reduce_row(Index i, double* padded_column) const;
  // v = N'y, y = N v.
  void reduce(const Motion& y, Vector& v) const;
  void expand(const Vector& v, Motion& y) const;
  // A y with G_E y = sigma, and mu with G_E'mu = t for t in the range of G_E'.
  void meet(const Vector& sigma, Motion& y) const;
  void multipliers(const Motion& t, Vector& mu) const;

 private:
  bool close_loops();
  void meet_cut(const Vector& sigma, Motion& y) const;

  SparsityPattern M_places_, J_places_;  // remembered
  Eigen::ArrayXd M_entry_, J_entry_;
  BodyRows rows_;
  JointTree tree_;
  std::vector<Index> equalities_, inequalities_;
  Index freedom_ = 0, padded_ = 0;
  double smallest_pivot_ = 1;
  bool remembers_ = false, has_basis_ = false;
  Motion y_E_;
  Matrix Nt_;                    // padded x 6 bodies
  Matrix cut_, turn_, Nt_tree_;  // N'g of the rows that close loops, as reflections and R; Q
  Vector scale_, beta_;
  mutable Vector all_, tree_mu_, sigma_, cut_mu_;
  mutable Motion rest_;
};

}  // namespace zwang
