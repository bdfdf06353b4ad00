#include <zwang/core/referee/orthogonal_rows.h>

namespace zwang {

OrthogonalRows::Column OrthogonalRows::solve(const Column& b) const {
  return triangle(rank_).triangularView<Eigen::Upper>().solve(b);
}

OrthogonalRows::Column OrthogonalRows::solve_transposed(const Column& b) const {
  return triangle(rank_).transpose().triangularView<Eigen::Lower>().solve(b);
}

OrthogonalRows::Split OrthogonalRows::split(const Column& g) const {
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

void OrthogonalRows::append(const Split& s) {
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

template <class S>
double OrthogonalRows::sigma_min_in(const ScaledProblem& scaled, const std::vector<Index>& rows) const {
  std::vector<Eigen::Triplet<S>> entries;
  for (Index k = 0; k < rank_; ++k)
    for (RowMatrix::InnerIterator it(scaled.J, rows[at(k)]); it; ++it)
      entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()),
                           S(it.value()) / S(scaled.row_norm[it.row()]));
  const auto J = sparse_of<Eigen::SparseMatrix<S, Eigen::RowMajor>>(rank_, scaled.size(), entries);
  // R^-T by forward substitution: J X - I is R' R^-T - I, and small where R' comes first.
  const MatrixX<S> lower = triangle(rank_).template cast<S>().transpose();
  const MatrixX<S> inverse = lower.template triangularView<Eigen::Lower>().solve(MatrixX<S>::Identity(rank_, rank_));
  const Eigen::SparseMatrix<Real> L = scaled.factor->matrixL();
  const Eigen::SparseMatrix<S, Eigen::RowMajor> upper = L.template cast<S>().transpose();
  MatrixX<S> X = Q().template cast<S>() * inverse;
  X = upper.template triangularView<Eigen::Upper>().solve(X).eval();
  X = (scaled.factor->permutationPinv() * X).eval();
  X = scaled.column_exponent.unaryExpr([](int e) { return S(std::ldexp(1.0, e)); }).matrix().asDiagonal() * X;
  const Eigen::SparseMatrix<S> M = scaled.M.template cast<S>();
  const auto unit = S(static_cast<double>(M.nonZeros() + 8) * static_cast<double>(std::numeric_limits<S>::epsilon()));
  const MatrixX<S> sizes = X.cwiseAbs(), MX = M * X, MX_sizes = M.cwiseAbs() * sizes;
  const MatrixX<S> E = (J * X - MatrixX<S>::Identity(rank_, rank_)).cwiseAbs() +
                       unit * (J.cwiseAbs() * sizes + MatrixX<S>::Identity(rank_, rank_));
  const S size = X.cwiseProduct(MX).sum() + unit * sizes.cwiseProduct(MX_sizes).sum();
  const double left = 1 - referee::up(static_cast<double>(E.norm()));
  return left > 0 ? referee::down(left / std::sqrt(static_cast<double>(size))) : 0;
}

double OrthogonalRows::sigma_min(const ScaledProblem& scaled, const std::vector<Index>& rows) const {
  if (rank_ == 0) return 1;
  const double first = sigma_min_in<double>(scaled, rows);
  return first > 0 ? first : sigma_min_in<Real>(scaled, rows);
}

}  // namespace zwang
