#pragma once

#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/block_cholesky.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The unit rows of a whitening over the columns of M itself, for methods that factor M + s G'G: with d = z - z_u in
// units of 2^exponent,
//
//   minimize 1/2 d'Md   subject to  g_i d = h_i  or  >= h_i,   g_i = J_i / row_norm_i.
//
// A contact of a sphere does not turn it, but its lever arm crossed with the normal leaves some 1e-17. Columns of such
// entries alone, that M does not tie either, are left out of g: they add squares of rounding to G M^-1 G', and three
// unknowns a sphere to a factor. Their own motion follows from the multipliers (faint).
struct UnitRows : Whitened {
  using Real = long double;

  SparseRows g;           // k rows, columns of M
  VectorX<Real> exact_h;  // k: h from the stored doubles
  struct Faint {
    Index row;  // of the problem
    int column;
    double pull;  // J_ij / M_jj
  };
  std::vector<Faint> faint;  // what g leaves out

  bool build(const Problem& problem, const Deadline& deadline = Deadline(), const SolveOptions& options = {}) {
    if (!Whitened::build(problem, deadline, options, false)) return false;
    const Preparation preparing;
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
      for (RowMatrix::InnerIterator it(problem.J, r); it; ++it) {
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
    leave_out_faint(problem);
    return true;
  }

  // z of the columns that g leaves out, which is z_u, moved as the multipliers say.
  void move_faint(const Vector& lambda, Vector& z) const {
    for (const Faint& e : faint) z[e.column] += e.pull * lambda[e.row];
  }

  // A multiplier of the problem's row from that of the unit row.
  double multiplier(Index i, Real unit) const {
    return static_cast<double>(std::ldexp(unit / Real(row_norm[i]), exponent));
  }

 private:
  void leave_out_faint(const Problem& p) {
    constexpr double faintest = tolerances::faint_entry;
    faint.clear();
    is_faint_.assign(at(p.size()), 1);
    mass_.resize(p.size());
    for (Index j = 0; j < p.size(); ++j)
      for (SparseMatrix::InnerIterator it(p.M, j); it; ++it) {
        if (it.row() == j)
          mass_[j] = it.value();
        else if (it.value() != 0)
          is_faint_[at(j)] = 0;
      }
    bool any = false;
    for (std::size_t e = 0; e < g.column.size(); ++e)
      if (g.value[e] * g.value[e] > faintest * faintest * mass_[g.column[e]]) is_faint_[at(g.column[e])] = 0;
    for (const int j : g.column) any = any || is_faint_[at(j)] != 0;
    if (!any) return;
    std::size_t entries = 0, e = 0;
    for (Index i = 0; i < rows(); ++i) {
      for (const auto end = at(g.begin[at(i) + 1]); e < end; ++e) {
        const int j = g.column[e];
        if (is_faint_[at(j)]) {
          faint.push_back({row[at(i)], j, g.value[e] * row_norm[i] / mass_[j]});
          continue;
        }
        g.column[entries] = j;
        g.value[entries++] = g.value[e];
      }
      g.begin[at(i) + 1] = static_cast<int>(entries);
    }
    g.column.resize(entries);
    g.value.resize(entries);
  }

  std::vector<char> is_faint_;  // columns
  Vector mass_;                 // diagonal of M
};

// Does an equality row so nearly repeat others that no answer has a bound (least_share() is 0)? False where to know
// that takes longer than a look. `g`: the entries of rows that are not whitened.
inline bool repeats_equalities(const Whitened& rows, const SparseRows* g = nullptr) {
  const Index entries = g ? std::ssize(g->value) : rows.G.nonZeros(), k = std::ranges::count(rows.equality, 1);
  if (k == 0 || k * k * rows.size() > 100 * entries) return false;
  Matrix basis = Matrix::Zero(rows.size(), k);
  Vector y;
  for (Index i = 0, e = 0; i < rows.rows(); ++i) {
    if (!rows.equality[at(i)]) continue;
    y.setZero(rows.size());
    if (!g) rows.add(i, 1.0, y);
    for (int p = g ? g->begin[at(i)] : 0; g && p < g->begin[at(i) + 1]; ++p) y[g->column[at(p)]] = g->value[at(p)];
    if (g) rows.factor.solve_lower(y);
    for (Index j = 0; j < e; ++j) y -= basis.col(j).dot(y) * basis.col(j);
    if (!(10 * y.norm() > std::sqrt(tolerances::promise_softness))) return true;
    basis.col(e++) = y.normalized();
  }
  return false;
}

}  // namespace zwang
