#pragma once

#include <numeric>

#include <zwang/solvers/common/equality_elimination.h>

// The elimination of equality rows step by step: the next row, its reflection, and the null space at the end.

namespace zwang {

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
void EqualityElimination<Scalar>::reduce(const MatrixX<Scalar>& Gt, const std::vector<int>& begin,
                                         const std::vector<int>& end, const std::vector<Index>& columns,
                                         const Deadline& deadline, MatrixX<Scalar>& A) const {
  if constexpr (has_sparse)
    if (is_sparse()) return sparse_.reduce(Gt, columns, A);
  constexpr Index seldom = 64;  // columns between two looks at the clock
  A.setZero(freedom(), std::ssize(columns));
  for (Index j = 0; j < A.cols(); ++j) {
    if (j % seldom == seldom - 1) deadline.keep();
    const Index i = columns[j];
    for (Index at = begin[i]; at < end[i]; ++at) {
      const Scalar& g = Gt(at, i);
      if (rank() == 0)
        A(at, j) = g;
      else if (g != Scalar(0))
        A.col(j) += g * Nt_.col(at);
    }
  }
}

// Range first, then what is free.
template <class Scalar>
bool EqualityElimination<Scalar>::factorize_sparse(const MatrixX<Scalar>& Gt, const std::vector<Index>& rows,
                                                   const Scalar& tolerance, const Deadline& deadline) {
  if constexpr (has_sparse) {
    if (!sparse_.factorize(Gt, rows, tolerance, deadline)) return false;
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
void EqualityElimination<Scalar>::factorize(const MatrixX<Scalar>& Gt, const std::vector<Index>& rows,
                                            const Scalar& tolerance, const Deadline& deadline, bool try_sparse) {
  n_ = Gt.rows();
  const auto m = static_cast<Index>(rows.size());
  const Index blocks = (n_ + block - 1) / block;
  padded_size_ = blocks * block;
  if (try_sparse && factorize_sparse(Gt, rows, tolerance, deadline)) return;
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
    V_.col(j).head(n_) = Gt.col(rows[j]);
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
