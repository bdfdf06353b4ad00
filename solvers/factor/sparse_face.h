#pragma once

#include <zwang/core/problem/disjoint_sets.h>
#include <zwang/core/problem/problem.h>
#include <zwang/solvers/factor/cone_face.h>
#include <zwang/solvers/factor/coupled_sum.h>
#include <zwang/solvers/linalg/block_cholesky.h>

namespace zwang {

// Rows that touch a few bodies each: walls and piles. The unknowns are those of M that a row touches, in the order of
// elimination. Where the weights of a cone are D = L L', the rows L'G go into the sparse Cholesky factor, so D has to
// be symmetric; unless couple() asks for LU, which takes longer.
class SparseFace final : public ConeFace {
 public:
  // rows: those of the cones, three of one pattern after each other, then the single ones.
  void reset(const Problem& problem, const SparseRows& rows, Index cones, const SolveOptions& options,
             const Deadline& deadline);
  void end_by(const Deadline& deadline) { deadline_ = deadline; }
  Index column(Index unknown) const { return factor_.column(static_cast<int>(unknown)); }

  Index unknowns() const override { return factor_.size(); }
  void slack(const Vector& v, Vector& s) const override;
  void force(const Vector& l, Vector& f) const override;
  void mass(const Vector& v, Vector& f) const override { multiply(mass_, v, f); }
  // From now on, until reset().
  void couple() { couples_ = true; }
  bool takes_unsymmetric() const override { return couples_; }
  bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) override;
  void solve(Vector& x) override { coupled_ ? sum_.solve(x) : factor_.solve(x); }
  bool divide_rows() override;
  double along(Index r, const Vector& v) const override;
  void push(Index r, double l, Vector& v) const override;
  double delassus(Index r, Index q) const override;

 private:
  bool invert_mass();

  SparseMatrix M_;
  Index cones_ = 0;
  SparseRows rows_, scaled_;
  std::vector<int> place_;
  std::vector<MatrixEntry> mass_;
  std::vector<double> weight_;
  BlockCholesky factor_;
  bool couples_ = false, coupled_ = false;  // coupled_: the factors at hand are those of sum_
  CoupledSum sum_;
  // Of divide_rows(): the blocks of M, their unknowns and inverses (dense, one after the other), and M^-1 G' by rows.
  struct Block {
    std::size_t first, inverse;  // into members_ and inverse_
  };
  DisjointSets tied_;
  std::vector<Block> blocks_;
  std::vector<int> block_of_, members_, order_, row_blocks_;
  std::vector<double> inverse_;
  SparseRows images_;
  mutable Vector scattered_;
  Deadline deadline_;
};

}  // namespace zwang
