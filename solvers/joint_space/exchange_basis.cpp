#include <zwang/solvers/joint_space/exchange_basis.h>

#include <cmath>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

using packets::all;
using packets::load;
using packets::multiply_add;
using packets::Packet;
using packets::store;

using packets::round_down;
}  // namespace

void ExchangeBasis::reserve(Index n, Index padded) {
  if (U_.rows() != padded || U_.cols() != n) U_.resize(padded, n);
  if (r_.size() == padded) return;
  for (Vector* part : {&r_, &t_, &remainder_, &x_}) part->setZero(padded);
}

void ExchangeBasis::reset(Index n, Index padded) {
  reserve(n, padded);
  n_ = n;
  padded_ = padded;
  used_ = packets::round_up(n);
  size_ = 0;
  U_.setIdentity();
}

double ExchangeBasis::split(const RowLanes& rows, Index i) {
  double *const r = r_.data(), *const t = t_.data();
  packets::in_parts(0, used_, [&]<int count>(Index c) {
    Packet sum[count];
    for (Packet& own : sum) own = all(0);
    const double* const u = U_.data() + c;
    rows.visit(i, [&](Index k, double a) {
      const double* const from = u + k * padded_;
      for (Index v = 0; v < count; ++v) sum[v] = multiply_add(all(a), load(from + v * packets::width), sum[v]);
    });
    for (Index v = 0; v < count; ++v) store(r + c + v * packets::width, sum[v]);
  });
  const Index whole = round_down(size_);
  for (Index c = 0; c < whole; c += packets::width) store(t + c, all(0));
  for (Index c = whole; c < whole + packets::width && c < used_; ++c) {
    const double own = r[c];
    t[c] = c < size_ ? 0.0 : own;
    r[c] = c < size_ ? own : 0.0;
  }
  Packet square = all(0);
  for (Index c = whole; c < used_; c += packets::width) {
    if (c > whole) {
      store(t + c, load(r + c));
      store(r + c, all(0));
    }
    square = multiply_add(load(t + c), load(t + c), square);
  }
  return length_ = std::sqrt(packets::sum(square));
}

// U't of every row, t = 0 before `from`.
template <bool add>
void ExchangeBasis::multiply(const double* t, Index from, double* y) const {
  bool first = !add;
  packets::in_parts(round_down(from), used_, [&]<int count>(Index c) {
    Packet own[count];
    for (Index v = 0; v < count; ++v) own[v] = load(t + c + v * packets::width);
    const double* u = U_.data() + c;
    for (Index k = 0; k < n_; ++k, u += padded_) {
      Packet sum = load(u) * own[0];
      for (Index v = 1; v < count; ++v) sum = multiply_add(load(u + v * packets::width), own[v], sum);
      y[k] = packets::sum(sum) + (first ? 0.0 : y[k]);
    }
    first = false;
  });
}

// x = U'w by columns up to `to`.
void ExchangeBasis::multiply_transposed(const double* w, Index to, double* x) const {
  packets::in_parts(0, to, [&]<int count>(Index c) {
    Packet sum[count];
    for (Packet& own : sum) own = all(0);
    const double* u = U_.data() + c;
    for (Index k = 0; k < n_; ++k, u += padded_)
      for (Index v = 0; v < count; ++v) sum[v] = multiply_add(all(w[k]), load(u + v * packets::width), sum[v]);
    for (Index v = 0; v < count; ++v) store(x + c + v * packets::width, sum[v]);
  });
}

const double* ExchangeBasis::find_remainder() {
  multiply<false>(t_.data(), size_, remainder_.data());
  return remainder_.data();
}

// U(c, k) += x_k y_c for c in [from, to), whole packets.
void ExchangeBasis::add_products(const double* x, const double* y, Index from, Index to) {
  packets::in_parts(from, to, [&]<int count>(Index c) {
    Packet own[count];
    for (Index v = 0; v < count; ++v) own[v] = load(y + c + v * packets::width);
    double* u = U_.data() + c;
    for (Index k = 0; k < n_; ++k, u += padded_) {
      if (x[k] == 0) continue;  // at first: what the row does not meet
      const Packet scale = all(x[k]);
      for (Index v = 0; v < count; ++v) {
        double* const at = u + v * packets::width;
        store(at, multiply_add(scale, own[v], load(at)));
      }
    }
  });
}

// The reflection I - beta w w', w = t + sign |t| e_q, turns Z until its first column is along the remainder.
void ExchangeBasis::append() {
  const double top = t_[size_], from_zero = std::copysign(length_, top);
  const double beta = 1 / (length_ * (length_ + std::abs(top))), reciprocal = -1 / (length_ * length_);
  double *const along = remainder_.data(), *const turned = x_.data(), *const u = U_.data() + size_;
  for (Index k = 0; k < n_; ++k) {
    turned[k] = -beta * zwang::multiply_add(from_zero, u[k * padded_], along[k]);
    along[k] *= reciprocal;
  }
  add_products(along, r_.data(), 0, packets::round_up(size_));
  add_products(turned, t_.data(), round_down(size_), used_);
  for (Index k = 0; k < n_; ++k) u[k * padded_] = -along[k];
  ++size_;
}

void ExchangeBasis::drop(Index j) {
  double *const w = remainder_.data(), *const x = x_.data(), *const t = t_.data();
  double square = 0;
  for (Index k = 0; k < n_; ++k) square = zwang::multiply_add(U_(j, k), U_(j, k), square);
  const double reciprocal = 1 / std::sqrt(square);
  for (Index k = 0; k < n_; ++k) w[k] = reciprocal * U_(j, k);
  // N'w, and Z'w, which is rounding.
  multiply_transposed(w, used_, x);
  for (Index c = round_down(size_); c < used_; ++c) {
    t[c] = c < size_ ? 0.0 : -x[c];
    x[c] = c < size_ ? -x[c] : 0.0;
  }
  multiply<true>(t, size_, w);
  for (Index c = 0; c < round_down(size_); ++c) x[c] = -x[c];
  --size_;
  add_products(w, x, 0, round_down(size_) + packets::width);
  for (Index k = 0; k < n_; ++k) {
    U_(j, k) = U_(size_, k);
    U_(size_, k) = w[k];
  }
}

void ExchangeBasis::solve(const Vector& s, const Vector& sigma, Vector& dv, Vector& dmu) {
  multiply_transposed(s.data(), used_, x_.data());
  x_.head(size_) = sigma.head(size_);
  dv.setZero();
  multiply<false>(x_.data(), 0, dv.data());
  x_ = dv - s;
  dmu.setZero();
  multiply_transposed(x_.data(), used_, dmu.data());
  for (Index c = size_; c < padded_; ++c) dmu[c] = 0;
}

}  // namespace zwang
