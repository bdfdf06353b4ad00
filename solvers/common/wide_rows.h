#pragma once

#include <cmath>
#include <type_traits>

#include <zwang/core/referee/double_double.h>
#include <zwang/solvers/common/whiten.h>

template <>
struct Eigen::NumTraits<zwang::DoubleDouble> : Eigen::GenericNumTraits<zwang::DoubleDouble> {};

namespace zwang {

// Double is refined with residuals in x87's long double, and in double-double where long double is another format;
// wider scalars with residuals of their own.
template <class Scalar>
using Wider = std::conditional_t<std::is_same_v<Scalar, double>, FactorReal, Scalar>;

// Rows of the problem's own J and c in the wider scalar, in the units of whitened rows: what decisions are checked with
// that rounding of the whitened ones could have made.

// By how much z misses unit row i, c - J z, and the sum of the terms of that difference.
template <class Wide>
struct UnitRest {
  Wide violation, terms;
};

template <class Scalar, class Wide>
UnitRest<Wide> rest_of(const BasicProblem<Scalar>& p, const BasicWhitened<Scalar>& whitened, Index i,
                       const VectorX<Wide>& z) {
  using std::abs, std::ldexp;
  const Index row = whitened.row[static_cast<std::size_t>(i)];
  Wide rest(p.c[row]), terms = abs(rest);
  for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, row); it; ++it) {
    const Wide term = Wide(it.value()) * z[it.col()];
    rest -= term;
    terms += abs(term);
  }
  const Wide unit(whitened.row_norm[i]);
  return {ldexp(Wide(rest / unit), -whitened.exponent), ldexp(Wide(terms / unit), -whitened.exponent)};
}

// A sum of rows of J, and how long it is once whitened: zero where the rows depend on each other.
template <class Scalar>
class RowSum {
 public:
  using Wide = Wider<Scalar>;

  void reset(Index n) { sum_.setZero(n); }
  void add(const BasicProblem<Scalar>& p, Index row, const Wide& factor) {
    for (typename Eigen::SparseMatrix<Scalar, Eigen::RowMajor>::InnerIterator it(p.J, row); it; ++it)
      sum_[it.col()] += Wide(it.value()) * factor;
  }
  Scalar length(const BasicWhitened<Scalar>& whitened) {
    whitened_ = sum_.template cast<Scalar>();
    whitened.factor.solve_lower(whitened_);
    return whitened_.norm();
  }
  const VectorX<Scalar>& whitened() const { return whitened_; }  // as of length()

 private:
  VectorX<Wide> sum_;
  VectorX<Scalar> whitened_;
};

}  // namespace zwang
