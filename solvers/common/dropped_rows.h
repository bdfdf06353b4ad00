#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/common/equality_elimination.h>
#include <zwang/solvers/common/wide_rows.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// Equality rows that an elimination dropped as combinations of the accepted ones, expressed by them in the wider
// scalar: joints 2^-50 apart are none, though double cannot tell them from repeated ones.
template <class Scalar>
class DroppedRows {
 public:
  using Wide = Wider<Scalar>;

  struct Rows {
    const BasicProblem<Scalar>& problem;
    const BasicWhitened<Scalar>& whitened;
    const EqualityElimination<Scalar>& elimination;
    std::span<const Index> equalities;  // whitened row of each row that was to be eliminated
    std::span<const Index> accepted;    // likewise of the accepted ones, in the order of the factor
  };

  // Whether obeying one of them could move z by more than `far` on unit rows.
  bool in_doubt(const Rows& rows, const VectorX<Wide>& z, const Scalar& far, const Deadline& deadline);

 private:
  void express(const Rows& rows, std::span<const Index> dropped);
  bool is_in_doubt(const Rows& rows, Index j, Index dropped, const VectorX<Wide>& z, const Scalar& far) const;
  // What rounding of the wider scalar leaves of column j.
  Scalar rounding(Index j) const {
    return Scalar(tolerances::rank * std::numeric_limits<Wide>::epsilon() * (1 + mu_.col(j).template lpNorm<1>()));
  }

  RowSum<Scalar> sum_;
  MatrixX<Wide> mu_;                   // accepted x dropped rows: the combinations
  MatrixX<Scalar> left_, correction_;  // padded n x dropped rows: what they leave; as mu_
  VectorX<Scalar> rho_;                // the lengths of what they leave
  VectorX<Wide> off_;                  // by how much z may miss each accepted row
  std::vector<char> done_;
};

// A row is done when rounding of the wider scalar explains what is left: one of small integers would otherwise be
// followed down to 1e-100.
template <class Scalar>
void DroppedRows<Scalar>::express(const Rows& rows, std::span<const Index> dropped) {
  const Index n = rows.whitened.size(), r = std::ssize(rows.accepted), count = std::ssize(dropped);
  const auto add = [&](Index i, const Wide& unit) {
    sum_.add(rows.problem, rows.whitened.row[i], unit / Wide(rows.whitened.row_norm[i]));
  };
  mu_.setZero(r, count);
  rho_.setConstant(count, std::numeric_limits<Scalar>::infinity());
  done_.assign(dropped.size(), false);
  for (bool improves = true; improves;) {
    improves = false;
    left_.setZero(rows.elimination.padded_size(), count);
    for (Index j = 0; j < count; ++j) {
      if (done_[j]) continue;
      sum_.reset(n);
      add(rows.equalities[dropped[j]], Wide(1));
      for (Index k = 0; k < r; ++k) add(rows.accepted[k], -mu_(k, j));
      const Scalar before = rho_[j];
      rho_[j] = sum_.length(rows.whitened);
      left_.col(j).head(n) = sum_.whitened();
      done_[j] = !(rho_[j] < before / Scalar(2) && rho_[j] > rounding(j));
      improves = improves || !done_[j];
    }
    rows.elimination.express(left_, correction_);
    mu_ += correction_.template cast<Wide>();
  }
}

// What is left of a row, rho, would take z by v / rho to where it holds; where nothing is left, it holds as well as
// those it is made of.
template <class Scalar>
bool DroppedRows<Scalar>::is_in_doubt(const Rows& rows, Index j, Index dropped, const VectorX<Wide>& z,
                                      const Scalar& far) const {
  using std::abs;
  const UnitRest<Wide> own = rest_of(rows.problem, rows.whitened, rows.equalities[dropped], z);
  const Wide hidden = std::numeric_limits<Wide>::epsilon() * own.terms;
  if (rho_[j] > rounding(j)) return Scalar(abs(own.violation) + hidden) > far * rho_[j];
  return abs(own.violation) > Wide(tolerances::violation) * (hidden + mu_.col(j).cwiseAbs().dot(off_));
}

template <class Scalar>
bool DroppedRows<Scalar>::in_doubt(const Rows& rows, const VectorX<Wide>& z, const Scalar& far,
                                   const Deadline& deadline) {
  using std::abs;
  constexpr std::size_t together = 64;
  const std::span<const Index> all = rows.elimination.rejected();
  if (all.empty()) return false;
  off_.resize(std::ssize(rows.accepted));
  for (Index k = 0; k < off_.size(); ++k) {
    const UnitRest<Wide> rest = rest_of(rows.problem, rows.whitened, rows.accepted[k], z);
    off_[k] = abs(rest.violation) + std::numeric_limits<Wide>::epsilon() * rest.terms;
  }
  for (std::size_t first = 0; first < all.size(); first += together) {
    deadline.keep();
    const auto dropped = all.subspan(first, std::min(together, all.size() - first));
    express(rows, dropped);
    for (Index j = 0; j < std::ssize(dropped); ++j)
      if (is_in_doubt(rows, j, dropped[j], z, far)) return true;
  }
  return false;
}

}  // namespace zwang
