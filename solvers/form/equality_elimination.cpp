#include <zwang/solvers/form/equality_elimination.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace zwang {

void EqualityElimination::rotate(Columns X) const {
  if (sparse_.holds()) return sparse_.rotate(X);
  for (Index k = 0; k < rank(); ++k) reflect(k, X.col(0));
}

void EqualityElimination::rotate_back(Columns X) const {
  if (sparse_.holds()) return sparse_.rotate_back(X);
  for (Index k = rank(); k-- > 0;) reflect(k, X.col(0));
}

void EqualityElimination::solve(Columns W) const {
  if (sparse_.holds()) return sparse_.solve(W);
  auto w = W.col(0);
  for (Index k = rank(); k-- > 0;) {
    const auto column = R_.col(order_[at(k)]);
    w[k] /= column[k];
    w.head(k) -= w[k] * column.head(k);
  }
}

void EqualityElimination::solve_transposed(Vector& w) const {
  if (sparse_.holds()) return sparse_.solve_transposed(w);
  for (Index k = 0; k < rank(); ++k) {
    const auto column = R_.col(order_[at(k)]);
    w[k] = (w[k] - column.head(k).dot(w.head(k))) / column[k];
  }
}

template <class Column>
void EqualityElimination::reflect(Index k, Column&& x) const {
  const auto v = V_.col(order_[at(k)]);
  Vec<double, block> sum = Vec<double, block>::Zero();
  each_block(mask(order_[at(k)]), [&](Index b) {
    sum += v.template segment<block>(b * block).cwiseProduct(x.template segment<block>(b * block));
  });
  const double dot = scale_[k] * sum.sum();
  each_block(mask(order_[at(k)]),
             [&](Index b) { x.template segment<block>(b * block) -= dot * v.template segment<block>(b * block); });
}

void EqualityElimination::measure_remaining(Index column) {
  Vec<double, block> sum = Vec<double, block>::Zero();
  each_block(mask(column), [&](Index b) { sum += V_.col(column).segment<block>(b * block).cwiseAbs2(); });
  norm_[column] = std::sqrt(sum.sum());
}

Index EqualityElimination::choose(double tolerance) {
  double largest = 0;
  for (const Index j : open_) largest = std::max(largest, norm_[j]);
  if (!(largest > tolerance)) return -1;
  const double enough = std::max(tolerance, tolerances::pivot_choice * largest);
  std::size_t best = 0;
  int fewest = std::numeric_limits<int>::max();
  for (std::size_t a = 0; a < open_.size(); ++a) {
    if (norm_[open_[a]] < enough) continue;
    int met = 0;
    each_block(mask(open_[a]), [&](Index b) { met += crowd_[at(b)]; });
    if (met >= fewest) continue;
    fewest = met;
    best = a;
  }
  const Index column = open_[best];
  open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(best));
  return column;
}

void EqualityElimination::eliminate(Index column) {
  const Index k = rank();
  auto v = V_.col(column);
  each_block(mask(column), [&](Index b) { --crowd_[at(b)]; });

  // The reflection takes what remains of the row to beta at its largest entry.
  Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  const double beta = v[largest] > 0 ? -norm_[column] : norm_[column];
  scale_[k] = 1 / (beta * (beta - v[largest]));
  v[largest] -= beta;
  R_(k, column) = beta;
  smallest_ = std::min(smallest_, norm_[column]);
  order_.push_back(column);
  pivot_entry_.push_back(largest);
  taken_[at(largest)] = 1;

  for (const Index j : open_) {
    std::uint64_t* own = mask_.data() + j * words_;
    if (!meet(mask(column), own)) continue;
    each_block(mask(column), [&](Index b) { crowd_[at(b)] += !(own[b / 64] >> (b % 64) & 1); });
    for (Index w = 0; w < words_; ++w) own[w] |= mask(column)[w];
    reflect(k, V_.col(j));
    R_(k, j) = V_(largest, j);
    V_(largest, j) = 0;
    measure_remaining(j);
  }
}

void EqualityElimination::form_null_space(const Deadline& deadline) {
  free_entry_.clear();
  for (Index i = 0; i < n_; ++i)
    if (!taken_[at(i)]) free_entry_.push_back(i);
  if (rank() == 0) return;
  N_.setZero(V_.rows(), freedom());
  free_mask_.assign(at(words_ * freedom()), 0);
  for (Index l = 0; l < freedom(); ++l) {
    deadline.keep();
    std::uint64_t* own = free_mask_.data() + l * words_;
    const Index b = free_entry_[at(l)] / block;
    own[b / 64] |= std::uint64_t{1} << (b % 64);
    N_(free_entry_[at(l)], l) = 1;
    for (Index k = rank(); k-- > 0;) {
      if (!meet(mask(order_[at(k)]), own)) continue;
      for (Index w = 0; w < words_; ++w) own[w] |= mask(order_[at(k)])[w];
      reflect(k, N_.col(l));
    }
  }
  Nt_ = N_.transpose();
}

void EqualityElimination::reduce(const Rows& G, const std::vector<Index>& rows, const Deadline& deadline,
                                 Matrix& A) const {
  if (sparse_.holds()) return sparse_.reduce(G, rows, A);
  constexpr Index seldom = 64;  // columns between two looks at the clock
  A.setZero(freedom(), std::ssize(rows));
  for (Index j = 0; j < A.cols(); ++j) {
    if (j % seldom == seldom - 1) deadline.keep();
    for (Rows::InnerIterator it(G, rows[at(j)]); it; ++it) {
      if (rank() == 0)
        A(it.col(), j) = it.value();
      else
        A.col(j) += it.value() * Nt_.col(it.col());
    }
  }
}

// Range first, then what is free.
bool EqualityElimination::factorize_sparse(const Rows& G, const std::vector<Index>& rows, double tolerance,
                                           const Deadline& deadline) {
  if (!sparse_.factorize(G, rows, tolerance, deadline)) return false;
  order_ = sparse_.order();
  open_ = sparse_.rejected();
  smallest_ = sparse_.smallest_accepted();
  pivot_entry_.resize(order_.size());
  std::iota(pivot_entry_.begin(), pivot_entry_.end(), Index{0});
  free_entry_.resize(at(freedom()));
  std::iota(free_entry_.begin(), free_entry_.end(), rank());
  return true;
}

void EqualityElimination::factorize(const Rows& G, const std::vector<Index>& rows, double tolerance,
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
  mask_.assign(at(words_ * m), 0);
  crowd_.assign(at(blocks), 0);
  taken_.assign(at(n_), 0);
  order_.clear();
  pivot_entry_.clear();
  open_.resize(rows.size());
  smallest_ = 1;

  for (Index j = 0; j < m; ++j) {
    open_[at(j)] = j;
    for (Rows::InnerIterator it(G, rows[at(j)]); it; ++it) V_(it.col(), j) = it.value();
    for (Index b = 0; b < blocks; ++b)
      if (V_.col(j).segment<block>(b * block) != Vec<double, block>::Zero()) {
        mask_[at(j * words_ + b / 64)] |= std::uint64_t{1} << (b % 64);
        ++crowd_[at(b)];
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
