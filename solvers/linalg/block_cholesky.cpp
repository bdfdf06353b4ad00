#include <zwang/solvers/linalg/block_cholesky.h>

#include <algorithm>

#include <zwang/solvers/linalg/dense_front.h>

namespace zwang {
namespace {

constexpr int long_front = 500;  // rows: to fill it takes milliseconds, far more than a look at the clock

}  // namespace

bool BlockCholesky::factorize(std::size_t f, const SparseMatrix& M, const SparseRows& rows,
                              std::span<const double> weight, const Deadline& deadline) {
  const Front &front = front_[f], &after = front_[f + 1];
  double* const work = work_.data();
  std::fill_n(work, at(front.stride) * at(front.size), 0.0);
  for (std::size_t k = front.mass; k < after.mass; ++k)
    work[mass_[k].column * front.stride + mass_[k].row] += M.valuePtr()[mass_[k].from];
  for (std::size_t k = front.row; k < after.row; ++k) {
    const int i = row_list_[k];
    if (weight[at(i)] == 0) continue;
    const int begin = rows.begin[at(i)], end = rows.begin[at(i) + 1];
    for (int p = begin; p < end; ++p) {
      const double scaled = weight[at(i)] * rows.value[at(p)];
      double* const column = work + local_[at(p)] * front.stride;
      for (int q = begin; q < end; ++q)
        if (local_[at(q)] >= local_[at(p)]) column[local_[at(q)]] += scaled * rows.value[at(q)];
    }
  }
  for (std::size_t k = front.child; k < after.child; ++k) {
    const Front& child = front_[at(child_[k])];
    const int rest = child.size - child.own;
    const int* const into = into_parent_.data() + child.index;
    const double* from = rest_.data() + child.rest;
    for (int c = 0; c < rest; ++c, from += rest) {
      double* const column = work + into[c] * front.stride;
      for (int r = c; r < rest; ++r) column[into[r]] += from[r];
    }
  }
  if (!DenseFront::factorize(work, front.size, front.own, front.stride, deadline)) return false;
  std::copy_n(work, at(front.stride) * at(front.own), panel_.data() + front.panel);
  const int rest = front.size - front.own;
  for (int c = 0; c < rest; ++c)
    std::copy_n(work + (front.own + c) * front.stride + front.own, rest, rest_.data() + front.rest + at(c) * at(rest));
  return true;
}

bool BlockCholesky::factorize(const SparseMatrix& M, const SparseRows& rows, std::span<const double> weight,
                              const Deadline& deadline) {
  if (valid_) {
    std::fill(dirty_.begin(), dirty_.end(), char(0));
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] != weight_[i]) dirty_[at(front_of_row_[i])] = 1;
  } else {
    std::fill(dirty_.begin(), dirty_.end(), char(1));
  }
  valid_ = false;
  for (std::size_t f = 0; f + 1 < front_.size(); ++f) {
    if (!dirty_[f]) continue;
    if (front_[f].size > long_front && deadline.passed()) return false;
    if (!factorize(f, M, rows, weight, deadline)) return false;
    if (front_[f].parent >= 0) dirty_[at(front_[f].parent)] = 1;
  }
  std::copy(weight.begin(), weight.end(), weight_.begin());
  valid_ = true;
  return true;
}

void BlockCholesky::solve(Vector& x) const {
  using Part = Eigen::Map<Vector>;
  using ConstPart = Eigen::Map<const Vector>;
  for (std::size_t f = 0; f + 1 < front_.size(); ++f) {
    const Front& front = front_[f];
    const int rest = front.size - front.own;
    Part below(gathered_.data(), rest);
    below.setZero();
    for (int c = 0; c < front.own; ++c) {
      const double* column = panel_.data() + front.panel + at(c) * at(front.stride);
      const double value = x[front.first + c] /= column[c];
      const int left = front.own - c - 1;
      x.segment(front.first + c + 1, left) -= value * ConstPart(column + c + 1, left);
      below += value * ConstPart(column + front.own, rest);
    }
    for (int r = 0; r < rest; ++r) x[index_[front.index + at(r)]] -= below[r];
  }
  for (std::size_t f = front_.size() - 1; f-- > 0;) {
    const Front& front = front_[f];
    const int rest = front.size - front.own;
    Part below(gathered_.data(), rest);
    for (int r = 0; r < rest; ++r) below[r] = x[index_[front.index + at(r)]];
    for (int c = front.own; c-- > 0;) {
      const double* column = panel_.data() + front.panel + at(c) * at(front.stride);
      const int left = front.own - c - 1;
      const double sum = ConstPart(column + c + 1, left).dot(x.segment(front.first + c + 1, left)) +
                         ConstPart(column + front.own, rest).dot(below);
      x[front.first + c] = (x[front.first + c] - sum) / column[c];
    }
  }
}

}  // namespace zwang
