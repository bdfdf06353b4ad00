#include <zwang/solvers/factor/inverse_factor.h>

#include <cmath>

#include <zwang/solvers/linalg/lanes.h>
#include <zwang/solvers/linalg/tolerances.h>
namespace zwang {

using lanes::at;
using lanes::round_up;
using lanes::width;

void InverseFactor::reset(Index padded, Index most) {
  padded_ = padded;
  size_ = 0;
  if (Q_.rows() == padded && Q_.cols() >= most) return;
  Q_.resize(padded, most);
  T_.resize(most, most);
  remainder_.resize(padded);
  for (Vector* part : {&d_, &r_, &again_, &cosine_, &sine_}) part->setZero(most + width);
}

double InverseFactor::split(const double* a) {
  lanes::multiply_transposed(Q_, size_, a, d_.data(), padded_);
  double* const rest = remainder_.data();
  for (Index k = 0; k < padded_; k += width) at(rest, k) = at(a, k);
  lanes::subtract(Q_, size_, d_.data(), rest, 0, padded_);
  length_ = std::sqrt(lanes::dot(rest, rest, padded_));
  // Kahan's criterion: one pass leaves eps / shortening of Q in the rest.
  if (length_ * length_ < tolerances::orthogonalize_again * lanes::dot(a, a, padded_)) {
    lanes::multiply_transposed(Q_, size_, rest, again_.data(), padded_);
    lanes::subtract(Q_, size_, again_.data(), rest, 0, padded_);
    for (Index j = 0; j < size_; ++j) d_[j] += again_[j];
    length_ = std::sqrt(lanes::dot(rest, rest, padded_));
  }
  const Index used = round_up(size_);
  for (Index k = 0; k < used; k += width) at(r_.data(), k).setZero();
  lanes::accumulate(T_, size_, d_.data(), r_.data(), 0, used);
  return length_;
}

void InverseFactor::append() {
  const double reciprocal = 1 / length_;
  for (Index k = 0; k < padded_; k += width) at(Q_.col(size_).data(), k) = reciprocal * at(remainder_.data(), k);
  auto column = T_.col(size_);
  column.setZero();
  column.head(size_) = -reciprocal * r_.head(size_);
  column[size_++] = reciprocal;
}

// Rotations of neighbouring columns gather row j of T in its last column, which leaves with it. What they have gathered
// after each is the length of that part of the row.
void InverseFactor::drop(Index j) {
  const Index pairs = --size_ - j;
  double gathered = T_(j, j), square = gathered * gathered;
  for (Index k = 0; k < pairs; ++k) {
    const double next = T_(j, j + 1 + k);
    square += next * next;
    const double norm = std::sqrt(square);
    cosine_[k] = next / norm;
    sine_[k] = gathered / norm;
    gathered = norm;
  }
  lanes::rotate(T_, j, pairs, cosine_.data(), sine_.data(), round_up(size_ + 1));
  lanes::rotate(Q_, j, pairs, cosine_.data(), sine_.data(), padded_);
  for (Index k = j; k < size_; ++k) {
    for (Index i = j; i <= k; ++i) T_(i, k) = T_(i + 1, k);
    T_(k + 1, k) = 0;
  }
}

// dv = Q (T'sigma - Q's) + s, dmu = T (T'sigma - Q's).
void InverseFactor::solve(const Vector& s, const Vector& sigma, Vector& dv, Vector& dmu) {
  lanes::multiply_transposed(T_, size_, sigma.data(), d_.data(), round_up(size_));
  lanes::multiply_transposed(Q_, size_, s.data(), again_.data(), padded_);
  d_.head(size_) -= again_.head(size_);
  dv.setZero();
  lanes::accumulate(Q_, size_, d_.data(), dv.data(), 0, padded_);
  dv += s;
  dmu.setZero();
  lanes::accumulate(T_, size_, d_.data(), dmu.data(), 0, round_up(size_));
}

}  // namespace zwang
