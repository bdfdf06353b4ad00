#pragma once

#include <span>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/session.h>

namespace zwang {

// G_E' = Q [R; 0] of sparse unit rows in no special order of bodies, by SuiteSparseQR (Davis, Algorithm 915, 2011): for
// rows whose orthogonal factors stay sparse, where equality_elimination.h works through dense columns.
//
// Its columns are ordered for fill, not for rank: a row is dropped where less than a tolerance is left of it when its
// turn comes. That finds exactly dependent rows, and can hide nearly dependent ones, so the smallest singular value of
// R is estimated, and anything less than clear is refused: reflections with pivots then decide.
//
// The analysis is kept as long as the pattern of the rows is, and the library's memory between calls
// (library_memory.h), where the host has installed it: a second factorization of the same shape allocates nothing then.
class SparseQr {
 public:
  using Rows = RowMatrix;

  // Row i is row rows[i] of G (k x n), of length 1; one that has at most `tolerance` left is rejected. False where
  // that does not pay (few or dense rows, more work than in dense columns, more than there is time for) or is not
  // clear.
  bool factorize(const Rows& G, const std::vector<Index>& rows, double tolerance, const Deadline& deadline);

  bool holds() const { return holds_ && factors_; }  // the last factorization was taken, and not dropped
  void drop() { holds_ = false; }
  const std::vector<Index>& order() const { return order_; }        // accepted, as positions in `rows`, in R's order
  const std::vector<Index>& rejected() const { return rejected_; }  // likewise
  double smallest_accepted() const { return smallest_; }            // estimate of R's smallest singular value

  // X := Q'X and X := Q X over the first n rows, the range first; A := N'G' of rows of G. The library prepares its
  // blocks of reflections anew for every product, and one of `together` columns costs as much as three or four of one.
  static constexpr Index together = 64;
  void rotate(Eigen::Ref<Matrix> X) const { multiply(true, X); }
  void rotate_back(Eigen::Ref<Matrix> X) const { multiply(false, X); }
  void reduce(const Rows& G, std::span<const Index> rows, Matrix& A) const;
  // W := R^-1 W and w := R^-T w over the first rank rows.
  void solve(Eigen::Ref<Matrix> W) const;
  void solve_transposed(Vector& w) const;

 private:
  struct Factors;

  bool load(const Rows& G, const std::vector<Index>& rows);
  void multiply(bool transposed, Eigen::Ref<Matrix> X) const;
  void list_columns();
  void estimate_smallest();

  Session<Factors> factors_;
  bool holds_ = false;
  Deadline deadline_;
  Index n_ = 0;
  std::vector<Index> order_, place_, rejected_;  // place_: of an accepted row among R's columns, dropped ones included
  double smallest_ = 1;
};

}  // namespace zwang
