#pragma once

#include <vector>

#include <zwang/solvers/linalg/block_cholesky.h>
#include <zwang/solvers/session.h>

namespace zwang {

// M + G'D G with blocks D that are not symmetric, as Coulomb's law has them where it is differentiated, and its sparse
// LU factors (Eigen's SparseLU). An order of the unknowns that serves M + G'G serves the factors: pivots stay on the
// diagonal where they are not much smaller than others.
class CoupledSum {
 public:
  // The next factorize() is for another pattern.
  void forget() { known_ = false; }
  // `place`: of each entry of the rows, its unknown. D, ray_weight as ConeFace::factorize. False on a breakdown.
  bool factorize(int unknowns, const std::vector<MatrixEntry>& mass, const SparseRows& rows,
                 const std::vector<int>& place, const std::vector<double>& D, const Vector& ray_weight);
  void solve(Vector& x);

 private:
  struct Lu;

  bool known_ = false;
  SparseMatrix sum_;
  std::vector<int> entry_;  // where each term of the sum goes, in the order of factorize()
  Session<Lu> lu_;
};

}  // namespace zwang
