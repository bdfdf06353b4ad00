#pragma once

#include <zwang/core/problem/problem.h>
#include <zwang/solvers/factor/cone_face.h>
#include <zwang/solvers/linalg/block_cholesky.h>

namespace zwang {

// Rows that touch a few bodies each: walls and piles. The unknowns are those of M that a row touches, in the order of
// elimination. Where the weights of a cone are D = L L', the rows L'G go into the sparse Cholesky factor, so D has to
// be symmetric.
class SparseFace final : public ConeFace {
 public:
  // rows: those of the cones, three of one pattern after each other, then the single ones.
  void reset(const Problem& problem, const SparseRows& rows, Index cones, const SolveOptions& options,
             const Deadline& deadline);
  Index column(Index unknown) const { return factor_.column(static_cast<int>(unknown)); }

  Index unknowns() const override { return factor_.size(); }
  void slack(const Vector& v, Vector& s) const override;
  void force(const Vector& l, Vector& f) const override;
  void mass(const Vector& v, Vector& f) const override;
  bool takes_unsymmetric() const override { return false; }
  bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) override;
  void solve(Vector& x) override { factor_.solve(x); }

 private:
  struct MassEntry {
    int row, column;
    double value;
  };

  Eigen::SparseMatrix<double> M_;
  Index cones_ = 0;
  SparseRows rows_, scaled_;
  std::vector<int> place_;
  std::vector<MassEntry> mass_;
  std::vector<double> weight_;
  BlockCholesky factor_;
  Deadline deadline_;
};

}  // namespace zwang
