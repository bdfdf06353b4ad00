#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <type_traits>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/sparse_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// Orthogonal elimination of the equality rows: G_E' = Q [R; 0] by Householder reflections, and the null-space basis N
// (the part of Q that R leaves free), so that y = y_E + N v with v free.
//
// Pivoting: among the rows whose remaining part is at least `threshold` of the largest one, the row that meets the
// fewest others goes first. The reflections of a mechanism then follow its tree from the leaves, and blocks of eight
// zeros are never touched. Strict pivoting (threshold 1) couples all fingers of a hand through the palm and loses that.
// A pivot stands at the largest entry of its column, wherever that is; `pivot_entry` and `free_entry` say where the
// parts of a rotated vector stand. The remaining norms are computed afresh after every reflection: downdating them
// loses the small ones, and those are what rank decisions are made of.
//
// Many sparse rows in double, where no body says what hangs together, go to a sparse QR first (sparse_qr.h): it keeps
// its zeros, and leaves to the reflections what is not clear.
template <class Scalar>
class EqualityElimination {
 public:
  using Rows = Eigen::SparseMatrix<Scalar, Eigen::RowMajor>;

  // Row i is row rows[i] of G (k x n), of length 1. A row whose remaining part is at most `tolerance` is rejected.
  void factorize(const Rows& G, const std::vector<Index>& rows, const Scalar& tolerance,
                 const Deadline& deadline = Deadline(), bool try_sparse = false);

  Index rank() const { return static_cast<Index>(order_.size()); }
  Index padded_size() const { return padded_size_; }
  Index freedom() const { return n_ - rank(); }
  const std::vector<Index>& order() const { return order_; }    // accepted, as positions in `rows`
  const std::vector<Index>& rejected() const { return open_; }  // likewise
  // A := N'G' of the rows of G that are listed; freedom x rows.
  void reduce(const Rows& G, const std::vector<Index>& rows, const Deadline& deadline, MatrixX<Scalar>& A) const;
  const Scalar& smallest_accepted() const { return smallest_; }      // 1 when there is none
  const Scalar& largest_rejected() const { return rejected_norm_; }  // 0 when there is none

  // x := Q'x and x := Q x, x of length padded_size() with zeros beyond n.
  template <class Column>
  void rotate(Column&& x) const {
    if constexpr (has_sparse)
      if (is_sparse()) return sparse_.rotate(x);
    for (Index k = 0; k < rank(); ++k) reflect(k, x);
  }
  void rotate_back(VectorX<Scalar>& x) const {
    if constexpr (has_sparse)
      if (is_sparse()) return sparse_.rotate_back(x);
    for (Index k = rank(); k-- > 0;) reflect(k, x);
  }
  // Between a rotated vector and its parts: w (rank, in pivot order) and v (freedom).
  void split(const VectorX<Scalar>& rotated, VectorX<Scalar>& w, VectorX<Scalar>& v) const {
    range(rotated, w);
    for (Index l = 0; l < freedom(); ++l) v[l] = rotated[free_entry_[l]];
  }
  template <class Rotated, class Range>
  void range(const Rotated& rotated, Range&& w) const {
    for (Index k = 0; k < rank(); ++k) w[k] = rotated[pivot_entry_[k]];
  }
  void join(const VectorX<Scalar>& w, const VectorX<Scalar>& v, VectorX<Scalar>& rotated) const {
    for (Index k = 0; k < rank(); ++k) rotated[pivot_entry_[k]] = w[k];
    for (Index l = 0; l < freedom(); ++l) rotated[free_entry_[l]] = v[l];
  }
  // w := R^-1 w and w := R^-T w over the first rank() entries.
  template <class Range>
  void solve(Range&& w) const {
    if constexpr (has_sparse)
      if (is_sparse()) return sparse_.solve(w);
    for (Index k = rank(); k-- > 0;) {
      w[k] /= R_(k, order_[k]);
      w.head(k) -= w[k] * R_.col(order_[k]).head(k);
    }
  }
  // The combinations of accepted rows that come nearest to the columns of X (padded_size() x any): w (rank x any). X is
  // lost.
  void express(MatrixX<Scalar>& X, MatrixX<Scalar>& w) const {
    if constexpr (has_sparse)
      if (is_sparse()) return sparse_.express(X, w);
    w.resize(rank(), X.cols());
    for (Index j = 0; j < X.cols(); ++j) {
      rotate(X.col(j));
      range(X.col(j), w.col(j));
      solve(w.col(j));
    }
  }
  void solve_transposed(VectorX<Scalar>& w) const {
    if constexpr (has_sparse)
      if (is_sparse()) return sparse_.solve_transposed(w);
    for (Index k = 0; k < rank(); ++k) {
      w[k] -= R_.col(order_[k]).head(k).dot(w.head(k));
      w[k] /= R_(k, order_[k]);
    }
  }

 private:
  bool is_sparse() const { return has_sparse && sparse_.holds(); }

  static constexpr Index block = 8;
  static constexpr double threshold = tolerances::pivot_choice;
  static constexpr bool has_sparse = std::is_same_v<Scalar, double>;
  using Mask = std::vector<std::uint64_t>;

  template <class Visit>
  void each_block(const std::uint64_t* mask, Visit&& visit) const {
    for (Index w = 0; w < words_; ++w)
      for (std::uint64_t bits = mask[w]; bits; bits &= bits - 1) visit(w * 64 + std::countr_zero(bits));
  }
  bool meet(const std::uint64_t* a, const std::uint64_t* b) const {
    for (Index w = 0; w < words_; ++w)
      if (a[w] & b[w]) return true;
    return false;
  }
  const std::uint64_t* mask(Index column) const { return mask_.data() + column * words_; }

  // x := (I - scale v v') x with reflection k.
  template <class Column>
  void reflect(Index k, Column&& x) const {
    const auto v = V_.col(order_[k]);
    Vec<Scalar, block> sum = Vec<Scalar, block>::Zero();
    each_block(mask(order_[k]), [&](Index b) {
      sum += v.template segment<block>(b * block).cwiseProduct(x.template segment<block>(b * block));
    });
    const Scalar dot = scale_[k] * sum.sum();
    each_block(mask(order_[k]),
               [&](Index b) { x.template segment<block>(b * block) -= dot * v.template segment<block>(b * block); });
  }
  void measure_remaining(Index column) {
    using std::sqrt;
    Vec<Scalar, block> sum = Vec<Scalar, block>::Zero();
    each_block(mask(column), [&](Index b) { sum += V_.col(column).template segment<block>(b * block).cwiseAbs2(); });
    norm_[column] = sqrt(sum.sum());
  }
  bool factorize_sparse(const Rows& G, const std::vector<Index>& rows, const Scalar& tolerance,
                        const Deadline& deadline);
  Index choose(const Scalar& tolerance);
  void eliminate(Index column);
  void form_null_space(const Deadline& deadline);

  SparseQr sparse_;
  Index n_ = 0, padded_size_ = 0, words_ = 0;
  MatrixX<Scalar> V_;                // padded n x rows: what remains of a row; after its turn, its reflection
  MatrixX<Scalar> R_;                // min(n, rows) x rows, column by row of G_E
  MatrixX<Scalar> N_, Nt_;           // padded n x freedom, not formed when rank = 0; its transpose
  Mask mask_, free_mask_;            // words_ a column: the blocks that may be non-zero
  std::vector<int> crowd_;           // a block: how many open columns have it
  std::vector<Index> open_, order_;  // columns undecided (at the end: rejected) and accepted
  std::vector<Index> pivot_entry_, free_entry_;
  std::vector<char> taken_;
  VectorX<Scalar> scale_, norm_;
  Scalar smallest_{1}, rejected_norm_{0};
};

template <class Scalar>
Index EqualityElimination<Scalar>::choose(const Scalar& tolerance) {
  Scalar largest(0);
  for (const Index j : open_) largest = std::max(largest, norm_[j]);
  if (!(largest > tolerance)) {
    rejected_norm_ = largest;
    return -1;
  }
  const Scalar enough = std::max(tolerance, Scalar(Scalar(threshold) * largest));
  std::size_t best = 0;
  int fewest = std::numeric_limits<int>::max();
  for (std::size_t a = 0; a < open_.size(); ++a) {
    if (norm_[open_[a]] < enough) continue;
    int met = 0;
    each_block(mask(open_[a]), [&](Index b) { met += crowd_[b]; });
    if (met >= fewest) continue;
    fewest = met;
    best = a;
  }
  const Index column = open_[best];
  open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(best));
  return column;
}

template <class Scalar>
void EqualityElimination<Scalar>::eliminate(Index column) {
  using std::abs;
  const Index k = rank();
  auto v = V_.col(column);
  each_block(mask(column), [&](Index b) { --crowd_[b]; });

  // The reflection takes what remains of the row to beta at its largest entry.
  Index at = 0;
  v.cwiseAbs().maxCoeff(&at);
  const Scalar beta = v[at] > Scalar(0) ? Scalar(-norm_[column]) : norm_[column];
  scale_[k] = Scalar(1) / (beta * (beta - v[at]));
  v[at] -= beta;
  R_(k, column) = beta;
  smallest_ = std::min(smallest_, norm_[column]);
  order_.push_back(column);
  pivot_entry_.push_back(at);
  taken_[at] = 1;

  for (const Index j : open_) {
    std::uint64_t* own = mask_.data() + j * words_;
    if (!meet(mask(column), own)) continue;
    each_block(mask(column), [&](Index b) { crowd_[b] += !(own[b / 64] >> (b % 64) & 1); });
    for (Index w = 0; w < words_; ++w) own[w] |= mask(column)[w];
    reflect(k, V_.col(j));
    R_(k, j) = V_(at, j);
    V_(at, j) = Scalar(0);
    measure_remaining(j);
  }
}

template <class Scalar>
void EqualityElimination<Scalar>::form_null_space(const Deadline& deadline) {
  free_entry_.clear();
  for (Index i = 0; i < n_; ++i)
    if (!taken_[i]) free_entry_.push_back(i);
  if (rank() == 0) return;
  N_.setZero(V_.rows(), freedom());
  free_mask_.assign(static_cast<std::size_t>(words_ * freedom()), 0);
  for (Index l = 0; l < freedom(); ++l) {
    deadline.keep();
    std::uint64_t* own = free_mask_.data() + l * words_;
    const Index b = free_entry_[l] / block;
    own[b / 64] |= std::uint64_t{1} << (b % 64);
    N_(free_entry_[l], l) = Scalar(1);
    for (Index k = rank(); k-- > 0;) {
      if (!meet(mask(order_[k]), own)) continue;
      for (Index w = 0; w < words_; ++w) own[w] |= mask(order_[k])[w];
      reflect(k, N_.col(l));
    }
  }
  Nt_ = N_.transpose();
}

template <class Scalar>
void EqualityElimination<Scalar>::reduce(const Rows& G, const std::vector<Index>& rows, const Deadline& deadline,
                                         MatrixX<Scalar>& A) const {
  if constexpr (has_sparse)
    if (is_sparse()) return sparse_.reduce(G, rows, A);
  constexpr Index seldom = 64;  // columns between two looks at the clock
  A.setZero(freedom(), std::ssize(rows));
  for (Index j = 0; j < A.cols(); ++j) {
    if (j % seldom == seldom - 1) deadline.keep();
    for (typename Rows::InnerIterator it(G, rows[j]); it; ++it) {
      if (rank() == 0)
        A(it.col(), j) = it.value();
      else
        A.col(j) += it.value() * Nt_.col(it.col());
    }
  }
}

// Range first, then what is free.
template <class Scalar>
bool EqualityElimination<Scalar>::factorize_sparse(const Rows& G, const std::vector<Index>& rows,
                                                   const Scalar& tolerance, const Deadline& deadline) {
  if constexpr (has_sparse) {
    if (!sparse_.factorize(G, rows, tolerance, deadline)) return false;
    order_ = sparse_.order();
    open_ = sparse_.rejected();
    smallest_ = sparse_.smallest_accepted();
    rejected_norm_ = sparse_.largest_rejected();
    pivot_entry_.resize(order_.size());
    std::iota(pivot_entry_.begin(), pivot_entry_.end(), Index{0});
    free_entry_.resize(static_cast<std::size_t>(freedom()));
    std::iota(free_entry_.begin(), free_entry_.end(), rank());
    return true;
  }
  return false;
}

template <class Scalar>
void EqualityElimination<Scalar>::factorize(const Rows& G, const std::vector<Index>& rows, const Scalar& tolerance,
                                            const Deadline& deadline, bool try_sparse) {
  n_ = G.cols();
  const auto m = static_cast<Index>(rows.size());
  const Index blocks = (n_ + block - 1) / block;
  padded_size_ = blocks * block;
  if (try_sparse && factorize_sparse(G, rows, tolerance, deadline)) return;
  sparse_.drop();
  words_ = (blocks + 63) / 64;
  V_.setZero(padded_size_, m);
  R_.setZero(std::min(n_, m), m);
  norm_.setZero(m);
  scale_.setZero(m);
  mask_.assign(static_cast<std::size_t>(words_ * m), 0);
  crowd_.assign(static_cast<std::size_t>(blocks), 0);
  taken_.assign(static_cast<std::size_t>(n_), 0);
  order_.clear();
  pivot_entry_.clear();
  open_.resize(rows.size());
  smallest_ = Scalar(1);
  rejected_norm_ = Scalar(0);

  for (Index j = 0; j < m; ++j) {
    open_[j] = j;
    for (typename Rows::InnerIterator it(G, rows[j]); it; ++it) V_(it.col(), j) = it.value();
    for (Index b = 0; b < blocks; ++b)
      if (V_.col(j).template segment<block>(b * block) != Vec<Scalar, block>::Zero()) {
        mask_[j * words_ + b / 64] |= std::uint64_t{1} << (b % 64);
        ++crowd_[b];
      }
    measure_remaining(j);
  }
  for (Index j = choose(tolerance); j >= 0; j = choose(tolerance)) {
    deadline.keep();
    eliminate(j);
  }
  form_null_space(deadline);
}

}  // namespace zwang
