#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include <zwang/core/problem/solver.h>
#include "tests/solvers/small_problems.h"

namespace zwang {

// Masses 1, 1.5, 2, ...; the first rows are equality rows.
inline Problem make_problem(const Matrix& J, const Vector& c, const Vector& z_u, std::size_t equalities = 0) {
  Problem p{.name = "contract"};
  const Index n = z_u.size(), m = c.size();
  p.M.resize(n, n);
  p.M.setIdentity();
  for (Index i = 0; i < n; ++i) p.M.coeffRef(i, i) = 1 + 0.5 * static_cast<double>(i);
  p.z_u = z_u;
  p.J = J.sparseView();
  p.J.resize(m, n);
  p.J = J.sparseView();
  p.c = c;
  for (Index i = 0; i < m; ++i) {
    p.kind.push_back(static_cast<std::size_t>(i) < equalities ? RowKind::equality : RowKind::inequality);
    p.key.push_back({.constraint = static_cast<std::uint64_t>(i), .row = 0});
  }
  return p;
}

inline bool claims_solved(const Solution& s) {
  return s.status == Status::solved || s.status == Status::solved_ill_conditioned;
}

// u_I >= 0, J'u = 0 up to `tolerance`, c'u > 0.
inline bool certificate_holds(const Problem& p, const Vector& u, double tolerance) {
  using Real = long double;
  if (u.size() != p.rows() || !u.allFinite()) return false;
  VectorX<Real> force = VectorX<Real>::Zero(p.size());
  Real work = 0, size = 0;
  for (Index i = 0; i < p.rows(); ++i) {
    if (!p.is_equality(i) && u[i] < 0) return false;
    if (u[i] == 0) continue;
    work += Real(p.c[i]) * u[i];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
      force[it.col()] += Real(it.value()) * u[i];
      size = std::max(size, std::abs(Real(it.value()) * u[i]));
    }
  }
  return work > 0 && force.lpNorm<Eigen::Infinity>() <= tolerance * std::max(size, work);
}

// Is there a k with J k = c?
inline bool in_range(const Problem& p) {
  if (p.rows() == 0) return true;
  const Matrix J(p.J);
  const Eigen::CompleteOrthogonalDecomposition<Matrix> qr(J);
  return (J * qr.solve(p.c) - p.c).norm() <= 1e-13 * p.c.norm();
}

}  // namespace zwang
