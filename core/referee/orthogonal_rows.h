#pragma once

#include <zwang/core/problem/types.h>
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
  Column solve(const Column& b) const { return triangle(rank_).triangularView<Eigen::Upper>().solve(b); }
  Column solve_transposed(const Column& b) const {
    return triangle(rank_).transpose().triangularView<Eigen::Lower>().solve(b);
  }

  // g = G' alpha + remainder, |remainder| = left; `dependent` when the remainder is rounding.
  struct Split {
    Column along, alpha, remainder;  // along = Q'g
    Real left = 0;
    bool dependent = false;
  };
  Split split(const Column& g) const {
    Split s{.along = Q().transpose() * g, .alpha = {}, .remainder = g};
    s.remainder -= Q() * s.along;
    const Column again = Q().transpose() * s.remainder;
    s.along += again;
    s.remainder -= Q() * again;
    s.alpha = solve(s.along);
    s.left = s.remainder.norm();
    s.dependent = s.left <= referee::rank * std::numeric_limits<Real>::epsilon() * (1 + s.alpha.template lpNorm<1>());
    return s;
  }
  void append(const Split& s) {
    if (rank_ == Q_.cols()) {
      const Index capacity = 2 * rank_ + 16;
      Q_.conservativeResize(Eigen::NoChange, capacity);
      R_.conservativeResize(capacity, capacity);
    }
    Q_.col(rank_) = s.remainder / s.left;
    R_.col(rank_).head(rank_) = s.along;
    R_(rank_, rank_) = s.left;
    ++rank_;
  }
  void truncate(Index r) { rank_ = r; }

  // A lower bound on the smallest singular value of the first r rows: 1 / |R^-1|_F, at most sqrt(r) too small.
  double sigma_min(Index r) const {
    if (r == 0) return 1;
    const MatrixX<Real> inverse = triangle(r).triangularView<Eigen::Upper>().solve(MatrixX<Real>::Identity(r, r));
    return static_cast<double>(1 / inverse.norm());
  }

 private:
  Eigen::Block<const MatrixX<Real>> triangle(Index r) const { return R_.topLeftCorner(r, r); }

  MatrixX<Real> Q_, R_;
  Index rank_ = 0;
};

}  // namespace zwang
