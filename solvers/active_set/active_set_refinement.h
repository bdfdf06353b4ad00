#pragma once

#include <cmath>
#include <limits>
#include <span>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/common/equality_elimination.h>
#include <zwang/solvers/common/wide_rows.h>
#include <zwang/solvers/linalg/thin_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The optimum of a fixed active set, all of whose rows hold with equality:
//
//   M (z - z_u) - J_A' lambda = 0,   J_A z = c_A
//
// by iterative refinement from z = z_u, lambda = 0: residuals of the original data in the wider scalar, corrections
// through the orthogonal factors of the whitened rows. The first pass is the solution, the next ones mend it (Bjorck,
// Numerical Methods for Least Squares Problems, 1996, sec. 2.9.2): the error contracts by eps / smallest pivot a pass
// and ends near eps of the wider scalar / smallest pivot.
// The answer depends on the active set alone: not on the path to it, and not on the rounding of whitening.
template <class Scalar>
class ActiveSetRefinement {
 public:
  using Wide = Wider<Scalar>;

  // Q R of the accepted equality rows, and Q R of the active inequality rows within their null space.
  struct Factors {
    const BasicWhitened<Scalar>& whitened;
    const EqualityElimination<Scalar>& equality;
    const BasicThinQr<Scalar>& inequality;
    std::span<const Index> equality_rows;  // whitened row of each accepted equality row, in pivot order
    std::span<const Index> active_rows;    // whitened row of each active inequality row, in the factor's order
  };

  bool keep_first = false;

  // False when the corrections do not contract: the factors are too ill-conditioned for the scalar.
  // Past the deadline it ends after two passes.
  bool solve(const BasicProblem<Scalar>& problem, const Factors& f, const Deadline& deadline);

  VectorX<Wide> z, lambda;              // n; m, zero outside the active set
  VectorX<Wide> first_z, first_lambda;  // of the first pass: what the factors give by themselves
  Scalar first_error{0};                // |y| between that and the last pass
  VectorX<Scalar> y;                    // padded n: Q (z - z_u) 2^-exponent
  VectorX<Scalar> mu;                   // multipliers of the active inequality rows (first q), on unit rows
  VectorX<Scalar> v;                    // free part of Q'y
  Scalar remaining{0};                  // estimate of the correction that another pass would make to y

 private:
  void compute_residuals(const BasicProblem<Scalar>& problem, const Factors& f);
  Scalar correct(const Factors& f);

  VectorX<Scalar> first_y_;
  VectorX<Wide> force_;                      // n: M (z_u - z) + J'lambda
  VectorX<Scalar> rho_, sigma_E_, sigma_I_;  // whitened residuals
  VectorX<Scalar> step_, rest_, dv_, s_w_, s_v_, mu_E_, mu_I_;
};

template <class Scalar>
void ActiveSetRefinement<Scalar>::compute_residuals(const BasicProblem<Scalar>& p, const Factors& f) {
  using std::ldexp;
  const int unit = -f.whitened.exponent;
  force_.setZero(p.size());
  for (Index j = 0; j < p.size(); ++j) {
    const Wide displacement = Wide(p.z_u[j]) - z[j];
    for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(p.M, j); it; ++it)
      force_[it.row()] += Wide(it.value()) * displacement;
  }
  const auto visit = [&](Index i, Scalar& sigma) {
    const Index row = f.whitened.row[i];
    Wide rest(p.c[row]);
    for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, row); it; ++it) {
      rest -= Wide(it.value()) * z[it.col()];
      force_[it.col()] += Wide(it.value()) * lambda[row];
    }
    sigma = static_cast<Scalar>(ldexp(Wide(rest / Wide(f.whitened.row_norm[i])), unit));
  };
  for (std::size_t k = 0; k < f.equality_rows.size(); ++k) visit(f.equality_rows[k], sigma_E_[k]);
  for (std::size_t j = 0; j < f.active_rows.size(); ++j) visit(f.active_rows[j], sigma_I_[j]);
  for (Index i = 0; i < p.size(); ++i) rho_[i] = static_cast<Scalar>(ldexp(force_[i], unit));
  if (p.size() > 0) f.whitened.factor.solve_lower(rho_);
}

// Solves dy - G_A' dmu = rho, G_A dy = sigma, and adds the correction to z, lambda, y and mu. Returns its length: |dy|,
// or |rho| where only the multipliers were off, as they are longest where active rows are near-parallel.
template <class Scalar>
Scalar ActiveSetRefinement<Scalar>::correct(const Factors& f) {
  using std::ldexp;
  const EqualityElimination<Scalar>& E = f.equality;
  const Index n = rho_.size(), q = f.inequality.size();
  const Scalar unbalanced = rho_.norm();

  // Range part of dy from the equality rows.
  E.solve_transposed(sigma_E_);
  dv_.setZero(E.freedom());
  step_.setZero(E.padded_size());
  E.join(sigma_E_, dv_, step_);
  E.rotate_back(step_);

  // Free part from the active rows, and their multipliers.
  rest_.setZero(E.padded_size());
  rest_.head(n) = rho_;
  E.rotate(rest_);
  E.split(rest_, s_w_, s_v_);
  for (Index j = 0; j < q; ++j) sigma_I_[j] -= f.whitened.dot(f.active_rows[j], step_);
  auto range = sigma_I_.head(q);
  auto mu = mu_I_.head(q);
  f.inequality.solve_transposed(range);
  mu.noalias() = f.inequality.Q().transpose() * s_v_;
  dv_ = s_v_;
  range -= mu;
  dv_.noalias() += f.inequality.Q() * range;
  mu = range;
  f.inequality.solve(mu);
  E.join(sigma_E_, dv_, step_);
  E.rotate_back(step_);

  // Multipliers of the equality rows from what the rest leaves of dy - rho.
  rest_ = step_;
  rest_.head(n) -= rho_;
  for (Index j = 0; j < q; ++j) f.whitened.add(f.active_rows[j], Scalar(-mu[j]), rest_);
  E.rotate(rest_);
  E.split(rest_, mu_E_, s_v_);
  E.solve(mu_E_);

  y += step_;
  v += dv_;
  this->mu.head(q) += mu;
  const auto add = [&](Index i, const Scalar& unit) {
    lambda[f.whitened.row[i]] += ldexp(Wide(Wide(unit) / Wide(f.whitened.row_norm[i])), f.whitened.exponent);
  };
  for (std::size_t k = 0; k < f.equality_rows.size(); ++k) add(f.equality_rows[k], mu_E_[k]);
  for (Index j = 0; j < q; ++j) add(f.active_rows[j], mu[j]);
  const Scalar length = std::max(Scalar(step_.norm()), unbalanced);
  rho_ = step_.head(n);
  if (n > 0) f.whitened.factor.solve_upper(rho_);
  for (Index i = 0; i < n; ++i) z[i] += ldexp(Wide(rho_[i]), f.whitened.exponent);
  return length;
}

template <class Scalar>
bool ActiveSetRefinement<Scalar>::solve(const BasicProblem<Scalar>& p, const Factors& f, const Deadline& deadline) {
  const Index n = p.size(), r = f.equality.rank();
  z = p.z_u.template cast<Wide>();
  lambda.setZero(p.rows());
  y.setZero(f.equality.padded_size());
  v.setZero(f.equality.freedom());
  rho_.setZero(n);
  for (VectorX<Scalar>* part : {&sigma_E_, &s_w_, &mu_E_}) part->resize(r);
  for (VectorX<Scalar>* part : {&mu, &dv_, &s_v_, &sigma_I_, &mu_I_}) part->setZero(f.equality.freedom());

  constexpr int passes = 20;
  const Scalar epsilon = std::numeric_limits<Scalar>::epsilon();
  Scalar last(0);
  for (int pass = 0; pass < passes; ++pass) {
    compute_residuals(p, f);
    const Scalar change = correct(f);
    if (keep_first && pass == 0) {
      first_z = z;
      first_lambda = lambda;
      first_y_ = y;
    }
    if (keep_first) first_error = (y - first_y_).norm();
    const Scalar size = y.norm() + f.whitened.free.norm();
    remaining = pass > 0 && change < last ? Scalar(change * (change / last)) : change;
    // The next correction would be about change^2 / size.
    if (pass > 0 && change * change <= epsilon * Scalar(tolerances::refined) * size * size) return true;
    if (pass > 1 && (change > last / Scalar(2) || deadline.passed())) return false;
    last = change;
  }
  return false;
}

}  // namespace zwang
