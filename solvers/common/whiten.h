#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/sparse_cholesky.h>

namespace zwang {

// Gauss' problem in whitened coordinates, with M = Q'Q, unit rows and a unit of length 2^exponent:
//
//   y = 2^-exponent Q (z - z_u):
//   minimize 1/2 |y|^2   subject to  g_i . y = h_i  or  >= h_i,   g_i = J_i Q^-1 / |J_i Q^-1|,  and the worst
//   violation of z_u (|h_i| of an equality row, h_i of an inequality row) in [1/2, 1).
//
// Shared by the native solvers and by the adapters (rivals deserve the whitened problem too). Rows that cannot matter
// are left out: zero rows that hold trivially, and inequality rows with c = -Inf. A zero row that cannot hold is
// reported in `conflict`. Every row, c and z_u are scaled by powers of two before they are multiplied, so that entries
// of 2^+-500 and c of 1e300 neither overflow nor vanish; powers of two are exact, so a problem and its scaled twin
// whiten to the same bits. A second build of the same shape and pattern of M allocates nothing.
template <class Scalar>
struct BasicWhitened {
  MatrixX<Scalar> Gt;           // n x k: column i is the unit row g_i
  VectorX<Scalar> h;            // k, on unit rows, in units of 2^exponent
  VectorX<Scalar> row_norm;     // k: |J_i Q^-1|, divided out of row i
  VectorX<Scalar> magnitude;    // k: |c_i| of the unit row + |z_u|_M: what, with |y|, a violation is small against
  std::vector<Index> row;       // k: the problem's row
  std::vector<char> equality;   // k
  std::vector<int> begin, end;  // k: g_i is zero outside [begin, end)
  std::vector<Index> idle;      // the problem's zero rows that hold trivially
  Index conflict = -1;          // a zero row that cannot hold, or -1
  VectorX<Scalar> free;         // n: Q z_u, in units of 2^exponent
  int exponent = 0;
  SparseCholesky<Scalar> factor;  // P M P' = L L', Q = L' P

  Index size() const { return Gt.rows(); }
  Index rows() const { return h.size(); }

  // False when M is not positive definite.
  bool build(const BasicProblem<Scalar>& problem, const Deadline& deadline = Deadline());

  // z = z_u + Q^-1 y.
  void primal(const BasicProblem<Scalar>& problem, const VectorX<Scalar>& y, VectorX<Scalar>& z) const {
    using std::ldexp;
    z = y;
    if (z.size() > 0) factor.solve_upper(z);
    for (Index i = 0; i < z.size(); ++i) z[i] = problem.z_u[i] + ldexp(z[i], exponent);
  }
  // Multipliers of the problem's rows from those of the unit rows.
  template <class Unit>
  void multipliers(const BasicProblem<Scalar>& problem, const Unit& unit, VectorX<Scalar>& lambda) const {
    lambda.setZero(problem.rows());
    for (Index i = 0; i < rows(); ++i) lambda[row[i]] = multiplier(i, unit[i]);
  }
  // The same for one row, and back.
  Scalar multiplier(Index i, const Scalar& unit) const {
    using std::frexp, std::ldexp;
    int e = 0;
    const Scalar mantissa = frexp(row_norm[i], &e);
    return ldexp(Scalar(unit / mantissa), exponent - e);
  }
  Scalar unit_multiplier(Index i, const Scalar& lambda) const {
    using std::frexp, std::ldexp;
    int e = 0;
    const Scalar mantissa = frexp(row_norm[i], &e);
    return ldexp(Scalar(lambda * mantissa), e - exponent);
  }

 private:
  using RowIterator = typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator;

  static int exponent_of(const Scalar& x) {
    using std::frexp;
    int e = 0;
    (void)frexp(x, &e);
    return e;
  }
  static Scalar largest(const BasicProblem<Scalar>& p, Index i) {
    using std::abs;
    Scalar top(0);
    for (RowIterator it(p.J, i); it; ++it)
      if (const Scalar a = abs(it.value()); a > top) top = a;
    return top;
  }
  void select_rows(const BasicProblem<Scalar>& p);

  std::vector<int> shift_;  // k: power of two still to be multiplied into h
  std::vector<int> entries_, touched_;
};

using Whitened = BasicWhitened<double>;

// The Farkas vector of a zero row that cannot hold: 0 >= c > 0, or 0 = c.
template <class Scalar>
void zero_row_certificate(const BasicProblem<Scalar>& problem, Index conflict, VectorX<Scalar>& u) {
  u.setZero(problem.rows());
  u[conflict] = problem.c[conflict] > Scalar(0) ? Scalar(1) : Scalar(-1);
}

template <class Scalar>
void BasicWhitened<Scalar>::select_rows(const BasicProblem<Scalar>& p) {
  using std::isfinite;
  conflict = -1;
  row.clear();
  idle.clear();
  equality.clear();
  for (Index i = 0; i < p.rows(); ++i) {
    if (!isfinite(p.c[i])) continue;
    if (largest(p, i) > Scalar(0)) {
      row.push_back(i);
      equality.push_back(p.is_equality(i));
    } else if (p.c[i] == Scalar(0) || (!p.is_equality(i) && p.c[i] < Scalar(0))) {
      idle.push_back(i);
    } else if (conflict < 0) {
      conflict = i;
    }
  }
}

template <class Scalar>
bool BasicWhitened<Scalar>::build(const BasicProblem<Scalar>& p, const Deadline& deadline) {
  using std::abs, std::ldexp;
  const Index n = p.size();
  if (n > 0 && !factor.factorize(p.M)) return false;
  select_rows(p);
  const auto k = static_cast<Index>(row.size());
  Gt.resize(n, k);
  h.resize(k);
  row_norm.resize(k);
  magnitude.resize(k);
  shift_.resize(row.size());
  begin.assign(row.size(), 0);
  end.assign(row.size(), static_cast<int>(n));

  // z_u with its largest entry near 1, and |z_u|_M in the same unit.
  const int z_exponent = n > 0 ? exponent_of(p.z_u.template lpNorm<Eigen::Infinity>()) : 0;
  free.resize(n);
  for (Index i = 0; i < n; ++i) free[i] = ldexp(p.z_u[i], -z_exponent);

  exponent = std::numeric_limits<int>::min();
  constexpr Index seldom = 64;  // rows between two looks at the clock
  for (Index i = 0; i < k; ++i) {
    if (i % seldom == seldom - 1) deadline.keep();
    const Index r = row[i];
    const int row_exponent = exponent_of(largest(p, r));
    const int unit = p.c[r] == Scalar(0) ? z_exponent : std::max(exponent_of(p.c[r]) - row_exponent, z_exponent);
    Scalar violation = ldexp(p.c[r], -row_exponent - unit);
    magnitude[i] = abs(violation);
    entries_.clear();
    Gt.col(i).setZero();
    for (RowIterator it(p.J, r); it; ++it) {
      const Scalar a = ldexp(it.value(), -row_exponent);
      const Index position = factor.position(it.col());
      Gt(position, i) = a;
      violation -= a * ldexp(free[it.col()], z_exponent - unit);
      entries_.push_back(static_cast<int>(position));
    }
    factor.solve_lower(entries_, Gt.col(i), touched_);
    begin[i] = touched_.front();
    end[i] = touched_.back() + 1;
    auto g = Gt.col(i).segment(begin[i], end[i] - begin[i]);
    const Scalar norm = g.norm();
    g /= norm;
    h[i] = violation / norm;
    magnitude[i] /= norm;
    row_norm[i] = ldexp(norm, row_exponent);
    shift_[i] = unit;
    if (h[i] > Scalar(0) || (equality[i] && h[i] < Scalar(0))) exponent = std::max(exponent, unit + exponent_of(h[i]));
  }
  if (exponent == std::numeric_limits<int>::min()) exponent = z_exponent;

  if (n > 0) factor.multiply_upper(free);
  for (Index i = 0; i < n; ++i) free[i] = ldexp(free[i], z_exponent - exponent);
  const Scalar free_norm = free.norm();
  for (Index i = 0; i < k; ++i) {
    const int shift = shift_[i] - exponent;
    h[i] = ldexp(h[i], shift);
    magnitude[i] = ldexp(magnitude[i], shift) + free_norm;
  }
  return true;
}

}  // namespace zwang
