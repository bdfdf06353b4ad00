#include <zwang/solvers/rivals/equality_rows.h>

#include <algorithm>

#include <zwang/solvers/finish/farkas.h>

namespace zwang {

bool EqualityRows::clearly_independent(const UnitProgram& program) {
  equality_ = program.rows_of(true);
  const auto count = static_cast<Index>(equality_.size());
  if (count == 0) return true;
  if (count > program.size()) return false;
  const UnitProgram::Rows G = program.some(equality_);
  const SparseMatrix S = G * G.transpose();
  if (!gram_.factorize(S)) return false;
  double least = 1;
  for (int j = 0; j < count; ++j) least = std::min(least, gram_.pivot(j));
  return least * least > tolerances::clear_squared_share;
}

void EqualityRows::factorize(const UnitProgram& program) {
  equality_ = program.rows_of(true);
  dropped_.clear();
  const Matrix columns = program.some(equality_).transpose();
  rank_ = 0;
  if (columns.size() == 0) return;
  qr_.compute(columns);
  const auto diagonal = qr_.matrixQR().diagonal();
  while (rank_ < diagonal.size() && std::abs(diagonal[rank_]) > dependent) ++rank_;
  for (Index j = rank_; j < columns.cols(); ++j) dropped_.push_back(pivoted(j));
  std::sort(dropped_.begin(), dropped_.end());
}

// In pivoted order G_E' P = Q [R S; 0 0]: dropped row d is the kept ones times R^-1 S e_d, so u = e_d - R^-1 S e_d (or
// its opposite) has G'u = 0, and h'u != 0 when the right-hand sides do not agree.
bool EqualityRows::conflict(const UnitProgram& program, Vector& u) const {
  if (dropped_.empty()) return false;
  const Index count = static_cast<Index>(equality_.size());
  const auto R = qr_.matrixQR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>();
  const Matrix combination = R.solve(qr_.matrixQR().topRightCorner(rank_, count - rank_));
  Vector motion;
  for (Index d = 0; d < combination.cols(); ++d) {
    u.setZero(program.rows());
    u[pivoted(rank_ + d)] = 1;
    for (Index j = 0; j < rank_; ++j) u[pivoted(j)] = -combination(j, d);
    if (program.h.dot(u) < 0) u = -u;
    if (proves_infeasible(program, u, motion)) return true;
  }
  return false;
}

Vector EqualityRows::shortest(const UnitProgram& program) const {
  Vector y = Vector::Zero(program.size());
  if (rank_ == 0) return y;
  for (Index j = 0; j < rank_; ++j) y[j] = program.h[pivoted(j)];
  const auto R = qr_.matrixQR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>();
  y.head(rank_) = Vector(R.transpose().solve(y.head(rank_)));
  y.applyOnTheLeft(qr_.householderQ());
  return y;
}

Matrix EqualityRows::free_motions(const UnitProgram& program) const {
  const Index n = program.size();
  Matrix basis = Matrix::Zero(n, n - rank_);
  if (basis.cols() == 0) return basis;
  basis.bottomRows(n - rank_).setIdentity();
  if (rank_) basis.applyOnTheLeft(qr_.householderQ());
  return basis;
}

}  // namespace zwang
