#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/preparation.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/linalg/sparse_cholesky.h>

namespace zwang {

// Gauss' problem in whitened coordinates, with M = Q'Q, unit rows and a unit of length 2^exponent:
//
//   y = 2^-exponent Q (z - z_u):
//   minimize 1/2 |y|^2   subject to  g_i . y = h_i  or  >= h_i,   g_i = J_i Q^-1 / |J_i Q^-1|,  and the worst
//   violation of z_u (|h_i| of an equality row, h_i of an inequality row) in [1/2, 1).
//
// The one whitening, of native solvers and of rivals. Rows stay sparse: where M is block-diagonal, a row has entries on
// the bodies that it touches and nowhere else, so the work grows with the non-zeros of M and J. What asks for dense
// rows copies them out (dense()).
//
// Rows that cannot matter are left out: zero rows that hold trivially, and inequality rows with c = -Inf. A zero row
// that cannot hold is reported in `conflict`. Every row, c and z_u are scaled by powers of two before they are
// multiplied, so that entries of 2^+-500 and c of 1e300 neither overflow nor vanish; powers of two are exact, so a
// problem and its scaled twin whiten to the same bits. A second build of the same shape and pattern of M allocates
// nothing.
template <class Scalar>
struct BasicWhitened {
  using Rows = Eigen::SparseMatrix<Scalar, Eigen::RowMajor>;

  Rows G;                      // k x n: the unit rows g_i, without zeros
  VectorX<Scalar> h;           // k, on unit rows, in units of 2^exponent
  VectorX<Scalar> row_norm;    // k: |J_i Q^-1|, divided out of row i
  VectorX<Scalar> magnitude;   // k: |c_i| of the unit row + |z_u|_M: what, with |y|, a violation is small against
  std::vector<Index> row;      // k: the problem's row
  std::vector<char> equality;  // k
  std::vector<Index> idle;     // the problem's zero rows that hold trivially
  Index conflict = -1;         // a zero row that cannot hold, or -1
  VectorX<Scalar> free;        // n: Q z_u, in units of 2^exponent
  Scalar free_norm{0};         // its length
  int exponent = 0;
  SparseCholesky<Scalar> factor;  // P M P' = L L', Q = L' P

  Index size() const { return free.size(); }
  Index rows() const { return h.size(); }

  // x 2^e by products, which are quicker than ldexp; by two where 2^e may not fit a double.
  class PowerOfTwo {
   public:
    explicit PowerOfTwo(int e) {
      using std::ldexp;
      const int half = std::abs(e) > 1000 ? e / 2 : 0;
      if (half != 0) first_ = ldexp(Scalar(1), half);
      if (e != 0) second_ = ldexp(Scalar(1), e - half);
    }
    Scalar operator*(const Scalar& x) const { return x * first_ * second_; }

   private:
    Scalar first_{1}, second_{1};
  };

  // False when M is not positive definite. Throws Stopped past the deadline, or where rows that M fills do not fit into
  // the memory there is. Without `keep_rows` G stays empty: for methods that need the norms alone.
  bool build(const BasicProblem<Scalar>& problem, const Deadline& deadline = Deadline(),
             const SolveOptions& options = {}, bool keep_rows = true);

  // g_i . y, and y += scale g_i; y of length n or more.
  template <class Column>
  Scalar dot(Index i, const Column& y) const {
    Scalar sum(0);
    for (typename Rows::InnerIterator it(G, i); it; ++it) sum += it.value() * y[it.col()];
    return sum;
  }
  template <class Column>
  void add(Index i, const Scalar& scale, Column&& y) const {
    for (typename Rows::InnerIterator it(G, i); it; ++it) y[it.col()] += scale * it.value();
  }
  // Gt := G', n x k: for methods whose own matrix this is.
  void dense(MatrixX<Scalar>& Gt) const {
    Gt.setZero(size(), rows());
    for (Index i = 0; i < rows(); ++i) add(i, Scalar(1), Gt.col(i));
  }

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

  // Row `row` of J, scaled, into place_ and value_. Returns its product with `free`, and whether L leaves each of its
  // entries alone (and they ascend), so that divide() does what solve() would.
  std::pair<Scalar, bool> load(const BasicProblem<Scalar>& p, Index row, const PowerOfTwo& scale) {
    const auto count = at(p.J.innerVector(row).nonZeros());
    place_.resize(count);
    value_.resize(count);
    Scalar moved(0);
    bool alone = true;
    int* place = place_.data();
    Scalar* value = value_.data();
    for (RowIterator it(p.J, row); it; ++it) {
      const int position = factor.position(it.col());
      alone = alone && factor.is_alone(position) && (place == place_.data() || position > place[-1]);
      *place++ = position;
      moved += (*value++ = scale * it.value()) * free[it.col()];
    }
    return {moved, alone};
  }
  // The loaded row times L^-T, to which place_ and value_ turn; returns its length.
  Scalar divide() {
    using std::sqrt;
    Scalar square(0);
    for (std::size_t e = 0; e < value_.size(); ++e) {
      value_[e] /= factor.pivot(place_[e]);
      square += value_[e] * value_[e];
    }
    return sqrt(square);
  }
  Scalar solve() {
    using std::sqrt;
    for (std::size_t e = 0; e < value_.size(); ++e) whole_[place_[e]] = value_[e];
    factor.solve_lower(place_, whole_, touched_);
    place_.swap(touched_);
    value_.resize(place_.size());
    Scalar square(0);
    for (std::size_t e = 0; e < value_.size(); ++e) {
      value_[e] = std::exchange(whole_[place_[e]], Scalar(0));
      square += value_[e] * value_[e];
    }
    return sqrt(square);
  }

  std::vector<int> row_exponent_;     // k: of the row's largest entry
  std::vector<int> shift_;            // k: power of two still to be multiplied into h
  VectorX<Scalar> whole_;             // n, zero between rows
  std::vector<int> place_, touched_;  // of a row's entries
  std::vector<Scalar> value_;
  DenseStorage storage_;
};

using Whitened = BasicWhitened<double>;

// A unit row near a point: by how much it may be violated there, negative where it is open, and by how much met,
// whatever rounding hides; what it pushes, if anything; and by how much a motion opens it.
struct NearRow {
  Index row;
  double violated, met, push, opens = 0;
};

// The Farkas vector of a zero row that cannot hold: 0 >= c > 0, or 0 = c.
template <class Scalar>
void zero_row_certificate(const BasicProblem<Scalar>& problem, Index conflict, VectorX<Scalar>& u) {
  u.setZero(problem.rows());
  u[conflict] = problem.c[conflict] > Scalar(0) ? Scalar(1) : Scalar(-1);
}

// How a solver begins: the solution reset, and the unit rows of the problem. False where these are the answer already,
// which is then written: M not positive definite, or a zero row that cannot hold.
template <class Rows>
bool begin(Rows& rows, const Problem& problem, const SolveOptions& options, const Deadline& deadline,
           Solution& solution) {
  if (!rows.build(problem, deadline, options)) {
    solution.reset(0, 0);
    solution.status = Status::bad_input;
    solution.message = "M is not positive definite";
    return false;
  }
  if (rows.conflict >= 0) {
    solution.reset(0, 0);
    solution.status = Status::infeasible;
    zero_row_certificate(problem, rows.conflict, solution.zero_certificate(problem.rows()));
    solution.message.append("row ").append(std::to_string(rows.conflict)).append(" is zero and cannot hold");
    return false;
  }
  solution.reset(problem.size(), problem.rows());
  return true;
}

template <class Scalar>
void BasicWhitened<Scalar>::select_rows(const BasicProblem<Scalar>& p) {
  using std::isfinite;
  conflict = -1;
  row.clear();
  idle.clear();
  equality.clear();
  row_exponent_.clear();
  for (Index i = 0; i < p.rows(); ++i) {
    if (!isfinite(p.c[i])) continue;
    if (const Scalar top = largest(p, i); top > Scalar(0)) {
      row.push_back(i);
      equality.push_back(p.is_equality(i));
      row_exponent_.push_back(exponent_of(top));
    } else if (p.c[i] == Scalar(0) || (!p.is_equality(i) && p.c[i] < Scalar(0)) || p.is_tangent(i)) {
      idle.push_back(i);
    } else if (conflict < 0) {
      conflict = i;
    }
  }
}

template <class Scalar>
bool BasicWhitened<Scalar>::build(const BasicProblem<Scalar>& p, const Deadline& deadline, const SolveOptions& options,
                                  bool keep_rows) {
  using std::abs, std::ldexp, std::sqrt;
  const Preparation preparing;
  const Index n = p.size();
  if (n > 0 && !factor.factorize(p.M)) return false;
  select_rows(p);
  const auto k = static_cast<Index>(row.size());
  if (G.rows() == k && G.cols() == n)
    G.setZero();
  else
    G.resize(k, n);
  h.resize(k);
  row_norm.resize(k);
  magnitude.resize(k);
  shift_.resize(row.size());
  whole_.setZero(n);

  // z_u with its largest entry near 1, and |z_u|_M in the same unit.
  const int z_exponent = n > 0 ? exponent_of(p.z_u.template lpNorm<Eigen::Infinity>()) : 0;
  free.resize(n);
  for (Index i = 0; i < n; ++i) free[i] = ldexp(p.z_u[i], -z_exponent);

  exponent = std::numeric_limits<int>::min();
  int last = 0;
  PowerOfTwo to_row(0), of_row(0);
  constexpr Index seldom = 64;  // rows between two looks at the clock
  for (Index i = 0; i < k; ++i) {
    if (i % seldom == seldom - 1) {
      deadline.keep();
      const double entries = static_cast<double>(G.data().size()) * static_cast<double>(k) / static_cast<double>(i);
      storage_.require(entries * static_cast<double>(sizeof(Scalar) + sizeof(int)) / sizeof(double), options);
    }
    const Index r = row[i];
    const int row_exponent = row_exponent_[i];
    const int unit = p.c[r] == Scalar(0) ? z_exponent : std::max(exponent_of(p.c[r]) - row_exponent, z_exponent);
    Scalar violation = p.c[r] == Scalar(0) ? Scalar(0) : Scalar(ldexp(p.c[r], -row_exponent - unit));
    magnitude[i] = abs(violation);
    if (row_exponent != last) {
      to_row = PowerOfTwo(-row_exponent);
      of_row = PowerOfTwo(row_exponent);
      last = row_exponent;
    }
    const auto [moved, alone] = load(p, r, to_row);
    violation -= PowerOfTwo(z_exponent - unit) * moved;
    const Scalar norm = alone ? divide() : solve();
    if (keep_rows) {
      G.startVec(i);
      for (std::size_t e = 0; e < value_.size(); ++e)
        if (const Scalar g = value_[e] / norm; g != Scalar(0)) G.insertBack(i, place_[e]) = g;
    }
    h[i] = violation / norm;
    magnitude[i] /= norm;
    row_norm[i] = of_row * norm;
    shift_[i] = unit;
    if (h[i] > Scalar(0) || (equality[i] && h[i] < Scalar(0))) exponent = std::max(exponent, unit + exponent_of(h[i]));
  }
  G.finalize();
  if (exponent == std::numeric_limits<int>::min()) exponent = z_exponent;

  if (n > 0) factor.multiply_upper(free);
  for (Index i = 0; i < n; ++i) free[i] = ldexp(free[i], z_exponent - exponent);
  // Its squares may underflow, next to rows of 1e300. With a length of 0 any rounding in a row once was a proof.
  free_norm = n > 0 ? std::max<Scalar>(free.norm(), free.template lpNorm<Eigen::Infinity>()) : Scalar(0);
  for (Index i = 0; i < k; ++i) {
    const PowerOfTwo shift(shift_[i] - exponent);
    h[i] = shift * h[i];
    magnitude[i] = shift * magnitude[i] + free_norm;
  }
  return true;
}

}  // namespace zwang
