#include <zwang/solvers/common/unit_rows.h>

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
using RowIterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;

}  // namespace

double UnitRows::length(std::size_t begin) {
  double square = 0;
  bool diagonal = true;
  for (std::size_t k = begin; k < g.column.size(); ++k) {
    const int j = g.column[k];
    diagonal = diagonal && alone_[at(j)];
    square += g.value[k] * g.value[k] / diagonal_[j];
  }
  if (diagonal) return std::sqrt(square);
  entries_.clear();
  for (std::size_t k = begin; k < g.column.size(); ++k) {
    const auto position = factor.position(g.column[k]);
    scratch_[position] = g.value[k];
    entries_.push_back(static_cast<int>(position));
  }
  factor.solve_lower(entries_, scratch_, touched_);
  square = 0;
  for (const int j : touched_) {
    square += scratch_[j] * scratch_[j];
    scratch_[j] = 0;
  }
  return std::sqrt(square);
}

bool UnitRows::build(const Problem& p, const Deadline& deadline) {
  const Index n = p.size();
  if (n > 0 && !factor.factorize(p.M)) return false;
  conflict = -1;
  row.clear();
  idle.clear();
  equality.clear();
  g.begin.assign(1, 0);
  g.column.clear();
  g.value.clear();
  h.resize(p.rows());
  norm.resize(p.rows());
  magnitude.resize(p.rows());
  scratch_.setZero(n);
  diagonal_.setZero(n);
  alone_.assign(at(n), 1);
  Real square = 0;
  for (Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it) {
      if (it.row() == j) diagonal_[j] += it.value();
      if (it.row() != j && it.value() != 0) alone_[at(j)] = 0;
      square += Real(p.z_u[it.row()]) * it.value() * p.z_u[j];
    }
  const Real free = std::sqrt(std::max(square, Real(0)));

  Real worst = 0;
  constexpr Index seldom = 1024;  // rows between two looks at the clock
  for (Index i = 0; i < p.rows(); ++i) {
    if (i % seldom == seldom - 1) deadline.keep();
    if (!std::isfinite(p.c[i])) continue;
    double top = 0;
    Real violation = p.c[i];
    for (RowIterator it(p.J, i); it; ++it) {
      top = std::max(top, std::abs(it.value()));
      violation -= Real(it.value()) * Real(p.z_u[it.col()]);
    }
    if (top == 0) {
      if (p.c[i] == 0 || (!p.is_equality(i) && p.c[i] < 0))
        idle.push_back(i);
      else if (conflict < 0)
        conflict = i;
      continue;
    }
    int shift = 0;
    (void)std::frexp(top, &shift);
    const std::size_t begin = g.column.size();
    for (RowIterator it(p.J, i); it; ++it)
      if (it.value() != 0) {
        g.column.push_back(static_cast<int>(it.col()));
        g.value.push_back(std::ldexp(it.value(), -shift));
      }
    const double size = length(begin);
    for (std::size_t k = begin; k < g.value.size(); ++k) g.value[k] /= size;
    g.begin.push_back(static_cast<int>(g.value.size()));
    const Index k = rows();
    row.push_back(i);
    equality.push_back(p.is_equality(i));
    norm[k] = std::ldexp(size, shift);
    h[k] = violation / Real(norm[k]);
    worst = std::max(worst, p.is_equality(i) ? std::abs(h[k]) : h[k]);
  }
  if (worst == 0) worst = free;
  (void)std::frexp(worst, &exponent);
  free_length = static_cast<double>(std::ldexp(free, -exponent));
  for (Index k = 0; k < rows(); ++k) {
    h[k] = std::ldexp(h[k], -exponent);
    const Real own = std::ldexp(std::abs(Real(p.c[row[at(k)]])) / Real(norm[k]), -exponent);
    magnitude[k] = static_cast<double>(std::min(own, Real(1e200))) + free_length;
  }
  return true;
}

double UnitRows::multiplier(Index i, Real unit) const {
  return static_cast<double>(std::ldexp(unit / Real(norm[i]), exponent));
}

double UnitRows::unit_multiplier(Index i, double lambda) const {
  return static_cast<double>(std::ldexp(Real(lambda) * Real(norm[i]), -exponent));
}

}  // namespace zwang
