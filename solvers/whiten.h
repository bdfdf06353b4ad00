#pragma once

#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "core/solver.h"

namespace zwang {

// Gauss' problem in whitened coordinates y = Q (z - z_u), with M = Q'Q and unit rows:
//
//   minimize 1/2 |y|^2   subject to  g_i . y = h_i  or  >= h_i,   g_i = J_i Q^-1 / |J_i Q^-1|,  h_i likewise scaled.
//
// Shared by the native solvers and by the adapters (rivals deserve the whitened problem too). Rows that cannot matter
// are left out: zero rows that hold trivially, and inequality rows with c = -Inf. A zero row that cannot hold is
// reported in `conflict`. Every row is first scaled by a power of two, so that entries of 2^+-500 neither overflow nor
// vanish.
template <class Scalar>
struct BasicWhitened {
  using SparseMatrix = Eigen::SparseMatrix<Scalar>;
  using Factor = Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<int>>;

  MatrixX<Scalar> Gt;          // n x k: column i is the unit row g_i
  VectorX<Scalar> h;           // k, on unit rows
  VectorX<Scalar> row_norm;    // k: |J_i Q^-1|, divided out of row i
  std::vector<Index> row;      // k: the problem's row
  std::vector<char> equality;  // k
  Index conflict = -1;         // a zero row that cannot hold, or -1
  Factor factor;               // P M P' = L L', Q = L' P

  Index size() const { return Gt.rows(); }
  Index rows() const { return h.size(); }

  // False when M is not positive definite.
  bool build(const BasicProblem<Scalar>& problem);

  // z = z_u + Q^-1 y.
  void primal(const BasicProblem<Scalar>& problem, const VectorX<Scalar>& y, VectorX<Scalar>& z) const {
    z = factor.permutationPinv() * VectorX<Scalar>(factor.matrixU().solve(y));
    z += problem.z_u;
  }
  // Multipliers of the problem's rows from those of the unit rows.
  void multipliers(const BasicProblem<Scalar>& problem, const VectorX<Scalar>& unit, VectorX<Scalar>& lambda) const {
    lambda.setZero(problem.rows());
    for (Index i = 0; i < rows(); ++i) lambda[row[static_cast<std::size_t>(i)]] = unit[i] / row_norm[i];
  }
};

using Whitened = BasicWhitened<double>;

// The Farkas vector of a zero row that cannot hold: 0 >= c > 0, or 0 = c.
template <class Scalar>
VectorX<Scalar> zero_row_certificate(const BasicProblem<Scalar>& problem, Index conflict) {
  VectorX<Scalar> u = VectorX<Scalar>::Zero(problem.rows());
  u[conflict] = problem.c[conflict] > Scalar(0) ? Scalar(1) : Scalar(-1);
  return u;
}

template <class Scalar>
bool BasicWhitened<Scalar>::build(const BasicProblem<Scalar>& p) {
  using std::abs, std::frexp, std::isfinite, std::ldexp, std::sqrt;
  const Index n = p.size(), m = p.rows();
  conflict = -1;
  row.clear();
  equality.clear();
  if (n > 0) {
    factor.compute(p.M);
    if (factor.info() != Eigen::Success) return false;
  }
  Gt.resize(n, m);
  h.resize(m);
  row_norm.resize(m);
  Index k = 0;
  VectorX<Scalar> g(n);
  for (Index i = 0; i < m; ++i) {
    Scalar largest(0);
    for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it)
      if (abs(it.value()) > largest) largest = abs(it.value());
    if (largest == Scalar(0)) {
      const bool holds = p.is_equality(i) ? p.c[i] == Scalar(0) : !(p.c[i] > Scalar(0));
      if (!holds && conflict < 0) conflict = i;
      continue;
    }
    if (!isfinite(p.c[i])) continue;
    int exponent = 0;
    (void)frexp(largest, &exponent);
    g.setZero();
    Scalar violation = ldexp(p.c[i], -exponent);
    for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
      const Scalar a = ldexp(it.value(), -exponent);
      g[it.col()] = a;
      violation -= a * p.z_u[it.col()];
    }
    const VectorX<Scalar> permuted = factor.permutationP() * g;
    Gt.col(k) = factor.matrixL().solve(permuted);
    const Scalar norm = Gt.col(k).norm();
    Gt.col(k) /= norm;
    h[k] = violation / norm;
    row_norm[k] = ldexp(norm, exponent);
    row.push_back(i);
    equality.push_back(p.is_equality(i));
    ++k;
  }
  Gt.conservativeResize(n, k);
  h.conservativeResize(k);
  row_norm.conservativeResize(k);
  return true;
}

}  // namespace zwang
