#pragma once

#include <Eigen/QR>
#include <vector>

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/linalg/sparse_cholesky.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The equality rows of a unit program by a column-pivoted QR of G_E', for rivals whose maths asks for independent
// equality rows (Ipopt) or for none at all (MMA, CCSAQ). A row within `dependent` of the span of the rows chosen
// before it counts as a combination of them.
class EqualityRows {
 public:
  static constexpr double dependent = tolerances::rival_dependent;

  // By sparse Cholesky of G_E G_E', far cheaper than the QR: its pivots are the distances of the rows to those before
  // them. True when none is small.
  bool clearly_independent(const UnitProgram& program);

  void factorize(const UnitProgram& program);

  Index rank() const { return rank_; }
  const std::vector<Index>& dropped() const { return dropped_; }  // unit rows, increasing

  // A Farkas vector over the unit rows when a dropped row contradicts the kept ones; false when none does.
  bool conflict(const UnitProgram& program, Vector& u) const;
  // The shortest y that meets the kept rows, and an orthonormal basis (n x (n - rank)) of the motions they leave free.
  Vector shortest(const UnitProgram& program) const;
  Matrix free_motions(const UnitProgram& program) const;

 private:
  Index pivoted(Index j) const { return equality_[at(qr_.colsPermutation().indices()[j])]; }

  Eigen::ColPivHouseholderQR<Matrix> qr_;  // of G_E': n x (equality rows)
  Index rank_ = 0;
  std::vector<Index> equality_, dropped_;
  SparseCholesky<double> gram_;  // of G_E G_E'
};

}  // namespace zwang
