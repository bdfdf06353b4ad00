#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/active_set/active_set_refinement.h>
#include <zwang/solvers/common/dropped_rows.h>
#include <zwang/solvers/common/equality_elimination.h>
#include <zwang/solvers/common/whiten.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/linalg/orthogonal_updates.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The dual active-set method of Goldfarb & Idnani, A numerically stable dual method for solving strictly convex
// quadratic programs (1983), on the whitened problem
//
//   minimize 1/2 |y|^2   subject to  G_E y = h_E,  G_I y >= h_I   (unit rows)
//
// for any scalar. The equality rows leave first: y = y_E + N v turns the rest into
//
//   minimize 1/2 |v|^2   subject to  A v >= b,   A = G_I N,  b = h_I - G_I y_E
//
// in n - rank unknowns. The method climbs the dual: (v, u) is always the optimum of the active rows with u >= 0, and
// each step takes the most violated row in, dropping rows whose multiplier would turn negative. Everything is done by
// orthogonal transformations of G; S = G G' is never formed, so digits are lost as eps / pivot, not eps / pivot^2.
//
// The answer is then computed afresh from the active set alone (active_set_refinement.h). It does not carry the path's
// rounding, so a warm start gives the digits of a cold one, and it leaves in z an error of eps_wide / pivot instead of
// eps / pivot. Where the mended answer changes a decision (a multiplier turns negative, a resting row
// is violated), the climb goes on from there.
template <class Scalar>
class GoldfarbIdnani {
 public:
  using Wide = Wider<Scalar>;

  Status solve(const BasicProblem<Scalar>& problem, const SolveOptions& options);

  bool sparse = false;  // a sparse QR of the equality rows where it pays

  // The answer: n; m; m when infeasible.
  const VectorX<Wide>& z() const { return refinement_.z; }
  const VectorX<Wide>& lambda() const { return refinement_.lambda; }
  VectorX<Scalar> certificate;
  std::vector<Index> redundant;
  int iterations = 0;
  Index rank = 0;
  Scalar smallest_accepted{1}, largest_rejected{0};
  bool contracted = true;  // the refinement's corrections became negligible

  // Estimate of |z - z*|_M / max(|z_u|_M, |z - z_u|_M): what the refinement still moved, what rounding hides in the
  // residuals of the active rows, amplified by the smallest pivot, and the multipliers that came out negative.
  Scalar error(const BasicProblem<Scalar>& problem) const;

  // `infeasible` with a combination so far from zero, or a contradiction so small, that rounding could be behind it.
  bool proof_in_doubt = false;
  // Whether the rows outside the active set, held against z from the problem's own J and c in the wider scalar, may be
  // violated (by 32 of its epsilon of their terms; on unit rows in Scalar, 8 of Scalar's cannot be told from rounding),
  // or could move z by more than `limit` (relative, as error()) though they are not.
  bool leaves_in_doubt(const BasicProblem<Scalar>& problem, const Scalar& limit);
  // Where the method ended: the whitened rows, and which of them are accepted equality rows and active inequality rows.
  BasicWhitened<Scalar>& whitened() { return whitened_; }
  const std::vector<Index>& accepted_equalities() const { return equality_rows_; }
  const std::vector<Index>& active_inequalities() const { return active_rows_; }

 private:
  enum State : char { resting, active, retired };

  static Scalar epsilon() { return std::numeric_limits<Scalar>::epsilon(); }
  static Scalar rank_tolerance() { return rounding(tolerances::rank); }
  static Scalar violation_tolerance() { return rounding(tolerances::violation); }
  // A hundred digits are more than doubles can ask for: no row of theirs is meant to differ by 1e-70, while masses of
  // a condition of 1e10 take ten digits, and rows that nearly repeat each other one after the other 13 each.
  static Scalar rounding(int epsilons) {
    if constexpr (std::numeric_limits<Scalar>::digits10 > 80) return Scalar(1e-70);
    return Scalar(epsilons) * epsilon();
  }

  void require_storage(const BasicProblem<Scalar>& problem, const SolveOptions& options);
  bool eliminate_equalities(const BasicProblem<Scalar>& problem);
  void reduce_inequalities();
  void warm_start(const BasicProblem<Scalar>& problem, const WarmStart& warm);
  Status climb(const BasicProblem<Scalar>& problem, const SolveOptions& options);
  Status enter(Index p, const BasicProblem<Scalar>& problem, const SolveOptions& options);
  Index most_violated();
  Index blocking(Scalar& step) const;
  void drop(Index j);
  void refresh();
  bool restore_dual_feasibility();
  bool certify(const BasicProblem<Scalar>& problem, Index row, const Scalar& sign, const Scalar& length);
  void list_active_rows();
  UnitRest<Scalar> rest(const BasicProblem<Scalar>& problem, Index i) const;
  bool solve_active_set(const BasicProblem<Scalar>& problem);
  void refine(const BasicProblem<Scalar>& problem);
  void observe(const BasicProblem<Scalar>& problem, const Observer& observer);
  void measure_margins();

  BasicWhitened<Scalar> whitened_;
  EqualityElimination<Scalar> elimination_;
  OrthogonalUpdates<Scalar> updates_;
  ActiveSetRefinement<Scalar> refinement_;
  std::vector<Index> equalities_, inequalities_;    // whitened rows
  std::vector<Index> equality_rows_, active_rows_;  // whitened rows, in the order of the factors
  std::vector<Index> active_;                       // columns of A_, in the order of the factor
  std::vector<char> state_;                         // of the columns of A_
  MatrixX<Scalar> A_;                               // freedom x inequality rows
  VectorX<Scalar> b_, magnitude_, slack_;           // of the inequality rows
  VectorX<Scalar> v_, u_, r_;                       // (v, u); R^-1 Q'a of the entering row a
  VectorX<Scalar> y_E_, x_, w_;                     // padded n; padded n; rank
  RowSum<Scalar> sum_;
  DroppedRows<Scalar> dropped_;
  Scalar y_E_norm_{0};
  Deadline deadline_;
  DenseStorage storage_;
};

template <class Scalar>
Status GoldfarbIdnani<Scalar>::solve(const BasicProblem<Scalar>& p, const SolveOptions& options) {
  deadline_ = Deadline(options.time_limit);
  require_storage(p, options);
  iterations = 0;
  redundant.clear();
  smallest_accepted = Scalar(1);
  largest_rejected = Scalar(0);
  rank = -1;
  proof_in_doubt = false;
  if (!whitened_.build(p, deadline_)) return Status::bad_input;
  if (whitened_.conflict >= 0) {
    zero_row_certificate(p, whitened_.conflict, certificate);
    return Status::infeasible;
  }
  if (!eliminate_equalities(p)) return Status::infeasible;
  reduce_inequalities();
  if (options.warm_start) warm_start(p, *options.warm_start);

  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    const Status status = climb(p, options);
    if (status == Status::infeasible) return status;
    refine(p);
    if (status != Status::solved) return status;
    if (restore_dual_feasibility() && most_violated() < 0) break;
    if (round + 1 == rounds) contracted = false;
  }
  measure_margins();
  return Status::solved;
}

// Whitened rows; reflections, R and N twice; reduced rows; Q and R of the active ones.
template <class Scalar>
void GoldfarbIdnani<Scalar>::require_storage(const BasicProblem<Scalar>& p, const SolveOptions& options) {
  const auto n = static_cast<double>(p.size()), m = static_cast<double>(p.rows());
  const auto e = static_cast<double>(std::count(p.kind.begin(), p.kind.end(), RowKind::equality));
  const double f = std::max(n - e, 0.0);
  const double numbers = n * m + n * e + std::min(n, e) * e + 2 * n * f + f * (m - e) + 2 * f * f;
  storage_.require(numbers * sizeof(Scalar) / sizeof(double), options);
}

// Equality rows that depend on others are dropped when they hold, and prove the problem infeasible when they do not.
template <class Scalar>
bool GoldfarbIdnani<Scalar>::eliminate_equalities(const BasicProblem<Scalar>& p) {
  using std::abs;
  equalities_.clear();
  inequalities_.clear();
  for (Index i = 0; i < whitened_.rows(); ++i) (whitened_.equality[i] ? equalities_ : inequalities_).push_back(i);
  elimination_.factorize(whitened_.Gt, equalities_, rank_tolerance(), deadline_, sparse);
  largest_rejected = elimination_.largest_rejected();
  equality_rows_.clear();
  for (const Index k : elimination_.order()) equality_rows_.push_back(equalities_[k]);
  active_.clear();
  active_rows_.clear();

  // The least-norm point of the accepted rows.
  const Index rank = elimination_.rank();
  w_.resize(rank);
  for (Index k = 0; k < rank; ++k) w_[k] = whitened_.h[equality_rows_[k]];
  elimination_.solve_transposed(w_);
  v_.setZero(elimination_.freedom());
  u_.setZero(elimination_.freedom());
  r_.setZero(elimination_.freedom());
  updates_.reset(elimination_.freedom(), elimination_.freedom());
  y_E_.setZero(elimination_.padded_size());
  elimination_.join(w_, v_, y_E_);
  elimination_.rotate_back(y_E_);
  y_E_norm_ = y_E_.norm();
  x_.resize(elimination_.padded_size());

  for (const Index k : elimination_.rejected()) {
    const Index i = equalities_[k];
    const Scalar rest = whitened_.h[i] - whitened_.Gt.col(i).dot(y_E_.head(whitened_.size()));
    // A proof takes twice as much, of more terms.
    const bool may_contradict = abs(rest) > violation_tolerance() / Scalar(2) * whitened_.magnitude[i];
    if (may_contradict && certify(p, i, rest < Scalar(0) ? Scalar(-1) : Scalar(1), largest_rejected)) return false;
    redundant.push_back(whitened_.row[i]);
  }
  for (const Index i : whitened_.idle)
    if (p.is_equality(i)) redundant.push_back(i);
  return true;
}

template <class Scalar>
void GoldfarbIdnani<Scalar>::reduce_inequalities() {
  const auto m = static_cast<Index>(inequalities_.size());
  elimination_.reduce(whitened_.Gt, whitened_.begin, whitened_.end, inequalities_, deadline_, A_);
  b_.resize(m);
  magnitude_.resize(m);
  slack_.resize(m);
  state_.assign(inequalities_.size(), resting);
  for (Index j = 0; j < m; ++j) {
    const Index i = inequalities_[j];
    Scalar held(0);
    for (Index at = whitened_.begin[i]; at < whitened_.end[i]; ++at) held += whitened_.Gt(at, i) * y_E_[at];
    b_[j] = whitened_.h[i] - held;
    magnitude_[j] = whitened_.magnitude[i];
  }
}

}  // namespace zwang

#include <zwang/solvers/active_set/goldfarb_idnani_answer.h>
#include <zwang/solvers/active_set/goldfarb_idnani_steps.h>
