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

  // A lower bound on the smallest singular value of these rows of a problem, at most about sqrt(rank) too small, and 0
  // where none is proven. With X about a right inverse of the rows J_i / |G_i|, E = J X - I:  d = X (I + E)^-1 s meets
  // J d = s, so |d|_M <= |X|_M |s| / (1 - |E|)  in Frobenius' norms. X comes of the factors, and E and |X|_M of the
  // stored J and M (Rump 2010, Acta Numer. 19, section 10): no factor is trusted. In double, and where that is too
  // little in Real.
  double sigma_min(const ScaledProblem& scaled, const std::vector<Index>& rows) const {
    if (rank_ == 0) return 1;
    const double first = sigma_min_in<double>(scaled, rows);
    return first > 0 ? first : sigma_min_in<Real>(scaled, rows);
  }

 private:
  template <class S>
  double sigma_min_in(const ScaledProblem& scaled, const std::vector<Index>& rows) const {
    std::vector<Eigen::Triplet<S>> entries;
    for (Index k = 0; k < rank_; ++k)
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(scaled.J, rows[static_cast<std::size_t>(k)]);
           it; ++it)
        entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()),
                             S(it.value()) / S(scaled.row_norm[it.row()]));
    Eigen::SparseMatrix<S, Eigen::RowMajor> J(rank_, scaled.size());
    J.setFromTriplets(entries.begin(), entries.end());
    // R^-T by forward substitution: J X - I is R' R^-T - I, and small where R' comes first.
    const MatrixX<S> lower = triangle(rank_).template cast<S>().transpose();
    const MatrixX<S> inverse = lower.template triangularView<Eigen::Lower>().solve(MatrixX<S>::Identity(rank_, rank_));
    const Eigen::SparseMatrix<Real> L = scaled.factor.matrixL();
    const Eigen::SparseMatrix<S, Eigen::RowMajor> upper = L.template cast<S>().transpose();
    MatrixX<S> X = Q().template cast<S>() * inverse;
    X = upper.template triangularView<Eigen::Upper>().solve(X).eval();
    X = (scaled.factor.permutationPinv() * X).eval();
    const Eigen::SparseMatrix<S> M = scaled.M.template cast<S>();
    const auto unit = S(static_cast<double>(M.nonZeros() + 8) * static_cast<double>(std::numeric_limits<S>::epsilon()));
    const MatrixX<S> sizes = X.cwiseAbs(), MX = M * X, MX_sizes = M.cwiseAbs() * sizes;
    const MatrixX<S> E = (J * X - MatrixX<S>::Identity(rank_, rank_)).cwiseAbs() +
                         unit * (J.cwiseAbs() * sizes + MatrixX<S>::Identity(rank_, rank_));
    const S size = X.cwiseProduct(MX).sum() + unit * sizes.cwiseProduct(MX_sizes).sum();
    const double left = 1 - referee::up(static_cast<double>(E.norm()));
    return left > 0 ? referee::down(left / std::sqrt(static_cast<double>(size))) : 0;
  }

  Eigen::Block<const MatrixX<Real>> triangle(Index r) const { return R_.topLeftCorner(r, r); }

  MatrixX<Real> Q_, R_;
  Index rank_ = 0;
};

}  // namespace zwang
