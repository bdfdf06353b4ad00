#pragma once

#include <zwang/core/referee/scaled_problem.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {

// Independent unit rows g_1 .. g_r as G' = Q R, grown and cut at the end: Gram-Schmidt with one reorthogonalization in
// FactorReal. Rank is decided row by row: a computed remainder is rounding once it is below u (1 + |alpha|_1), with
// alpha the coefficients of the row in the rows before it, so well-scaled combinations are told from near-parallel rows
// down to remainders of about 1e-17.
class OrthogonalRows {
 public:
  using Real = FactorReal;
  using Column = VectorX<Real>;

  explicit OrthogonalRows(Index n = 0) : Q_(n, 0), R_(0, 0) {}
  Index rank() const { return rank_; }

  auto Q() const { return Q_.leftCols(rank_); }  // n x rank
  // R^-1 b and R^-T b.
  Column solve(const Column& b) const;
  Column solve_transposed(const Column& b) const;

  // g = G' alpha + remainder, |remainder| = left; `dependent` when the remainder is rounding.
  struct Split {
    Column along, alpha, remainder;  // along = Q'g
    Real left = 0;
    bool dependent = false;
  };
  Split split(const Column& g) const;
  void append(const Split& s);
  void truncate(Index r) { rank_ = r; }

  // A lower bound on the smallest singular value of these rows of a problem, at most about sqrt(rank) too small, and 0
  // where none is proven. With X about a right inverse of the rows J_i / |G_i|, E = J X - I:  d = X (I + E)^-1 s meets
  // J d = s, so |d|_M <= |X|_M |s| / (1 - |E|)  in Frobenius' norms. X comes of the factors, and E and |X|_M of the
  // stored J and M (Rump 2010, Acta Numer. 19, section 10): no factor is trusted. In double, and where that is too
  // little in Real.
  double sigma_min(const ScaledProblem& scaled, const std::vector<Index>& rows) const;

 private:
  template <class S>
  double sigma_min_in(const ScaledProblem& scaled, const std::vector<Index>& rows) const;

  Eigen::Block<const MatrixX<Real>> triangle(Index r) const { return R_.topLeftCorner(r, r); }

  MatrixX<Real> Q_, R_;
  Index rank_ = 0;
};

}  // namespace zwang
