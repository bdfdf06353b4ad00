#pragma once

#include <utility>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang::referee {

// Gauss and Jordan on the first `columns` columns of a matrix of rationals, the first first: the pivots' columns, as
// many as the rank. Their rows come first.
template <class Rationals>
std::vector<Index> reduce(Rationals& rows, Index columns) {
  using Rational = typename Rationals::Scalar;
  std::vector<Index> pivots;
  for (Index j = 0; j < columns && std::ssize(pivots) < rows.rows(); ++j) {
    const Index top = std::ssize(pivots);
    Index found = top;
    while (found < rows.rows() && rows(found, j) == 0) ++found;
    if (found == rows.rows()) continue;
    rows.row(found).swap(rows.row(top));
    rows.row(top) /= Rational(rows(top, j));
    for (Index i = 0; i < rows.rows(); ++i) {
      const Rational factor = rows(i, j);
      if (i == top || factor == 0) continue;
      for (Index k = j; k < rows.cols(); ++k)
        if (rows(top, k) != 0) rows(i, k) -= factor * rows(top, k);
    }
    pivots.push_back(j);
  }
  return pivots;
}

}  // namespace zwang::referee
