#pragma once

#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/block_cholesky.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The unit rows of a whitening over the columns of M itself, for methods that factor M + s G'G: with d = z - z_u in
// units of 2^exponent,
//
//   minimize 1/2 d'Md   subject to  g_i d = h_i  or  >= h_i,   g_i = J_i / row_norm_i.
struct UnitRows : Whitened {
  using Real = long double;

  SparseRows g;           // k rows, columns of M
  VectorX<Real> exact_h;  // k: h from the stored doubles
  double free_norm = 0;   // |z_u|_M

  bool build(const Problem& problem, const Deadline& deadline = Deadline(), const SolveOptions& options = {}) {
    if (!Whitened::build(problem, deadline, options, false)) return false;
    const Preparation preparing;
    free_norm = free.norm();
    magnitude = magnitude.cwiseMin(tolerances::horizon);
    exact_h.resize(rows());
    const Real unit = std::ldexp(Real(1), -exponent);
    const auto most = at(problem.J.nonZeros());
    g.begin.assign(1, 0);
    g.column.resize(most);
    g.value.resize(most);
    std::size_t entries = 0;
    for (Index i = 0; i < rows(); ++i) {
      const Index r = row[at(i)];
      Real violation = problem.c[r];
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(problem.J, r); it; ++it) {
        if (it.value() == 0) continue;
        violation -= Real(it.value()) * Real(problem.z_u[it.col()]);
        g.column[entries] = static_cast<int>(it.col());
        g.value[entries++] = it.value() / row_norm[i];
      }
      g.begin.push_back(static_cast<int>(entries));
      exact_h[i] = violation / Real(row_norm[i]) * unit;
    }
    g.column.resize(entries);
    g.value.resize(entries);
    return true;
  }

  // A multiplier of the problem's row from that of the unit row.
  double multiplier(Index i, Real unit) const {
    return static_cast<double>(std::ldexp(unit / Real(row_norm[i]), exponent));
  }
};

}  // namespace zwang
