#pragma once

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
  Index column(Index unknown) const { return factor_.column(static_cast<int>(unknown)); }

  Index unknowns() const override { return factor_.size(); }
  void slack(const Vector& v, Vector& s) const override;
  void force(const Vector& l, Vector& f) const override;
  void mass(const Vector& v, Vector& f) const override;
  // From now on, until reset().
  void couple() { couples_ = true; }
  bool takes_unsymmetric() const override { return couples_; }
  bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) override;
  void solve(Vector& x) override { coupled_ ? sum_.solve(x) : factor_.solve(x); }

 private:
  Eigen::SparseMatrix<double> M_;
  Index cones_ = 0;
  SparseRows rows_, scaled_;
  std::vector<int> place_;
  std::vector<CoupledSum::Entry> mass_;
  std::vector<double> weight_;
  BlockCholesky factor_;
  bool couples_ = false, coupled_ = false;  // coupled_: the factors at hand are those of sum_
  CoupledSum sum_;
  Deadline deadline_;
};

}  // namespace zwang
