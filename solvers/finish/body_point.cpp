#include <zwang/solvers/finish/body_point.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/number/double_double.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using Lanes = BodyRows::Lanes;

// a b - product, exactly.
Lanes error_of(const Lanes& product, const Lanes& a, const Lanes& b) {
#ifdef __FMA__
  Lanes error;
  for (Index k = 0; k < BodyRows::lanes; ++k) error[k] = std::fma(a[k], b[k], -product[k]);
  return error;
#else
  // Dekker's halves of 26 bits: fma() would be a call for each entry.
  constexpr double split = 0x1p27 + 1;
  const Lanes a_high = split * a - (split * a - a), a_low = a - a_high;
  const Lanes b_high = split * b - (split * b - b), b_low = b - b_high;
  return ((a_high.cwiseProduct(b_high) - product) + a_high.cwiseProduct(b_low) + a_low.cwiseProduct(b_high)) +
         a_low.cwiseProduct(b_low);
#endif
}

// high + low, which stay in registers only where everything is inlined.
struct Sum {
  Lanes high = Lanes::Zero(), low = Lanes::Zero();

  [[gnu::always_inline]] void add(const Lanes& x) {
    const Lanes after = high + x, part = after - high;
    low += (high - (after - part)) + (x - part);
    high = after;
  }
  // a (x + x_low).
  [[gnu::always_inline]] void add_product(const Lanes& a, const Lanes& x, const Lanes& x_low) {
    const Lanes product = a.cwiseProduct(x);
    low += error_of(product, a, x) + a.cwiseProduct(x_low);
    add(product);
  }
};

}  // namespace

void BodyPoint::begin(const BodyRows& rows, const Motion& y) {
  unit_ = std::ldexp(1.0, rows.exponent);
  z_ = rows.z_u;
  z_rest_.setZero(BodyRows::lanes, rows.bodies());
  if (lambda_.size() < rows.rows()) {
    lambda_.resize(rows.rows());
    lambda_rest_.resize(rows.rows());
  }
  lambda_.setZero();
  lambda_rest_.setZero();
  move(rows, y);
}

void BodyPoint::move(const BodyRows& rows, const Motion& step) {
  for (Index b = 0; b < rows.bodies(); ++b) {
    Sum own{z_.col(b), z_rest_.col(b)};
    own.add(unit_ * BodyRows::times(rows.mass[at(b)].L_inverse_t, step.col(b)));
    z_.col(b) = own.high;
    z_rest_.col(b) = own.low;
  }
}

void BodyPoint::push(const BodyRows& rows, Index i, double unit) {
  const double step = unit_ * (unit / rows.row_norm[i]);
  const DoubleDouble sum = DoubleDouble::exact_sum(lambda_[i], step);
  lambda_[i] = sum.hi;
  lambda_rest_[i] += sum.lo;
}

void BodyPoint::begin_force(const BodyRows& rows) {
  force_.setZero(BodyRows::lanes, rows.bodies());
  force_rest_.setZero(BodyRows::lanes, rows.bodies());
  for (Index b = 0; b < rows.bodies(); ++b) {
    Sum d{rows.z_u.col(b), -z_rest_.col(b)}, sum;
    d.add(-z_.col(b));
    const BodyRows::Block& M = rows.mass[at(b)].M;
    for (Index c = 0; c < 6; ++c) sum.add_product(M.col(c), Lanes::Constant(d.high[c]), Lanes::Constant(d.low[c]));
    force_.col(b) = sum.high;
    force_rest_.col(b) = sum.low;
  }
}

// The sums over the entries of eight rows side by side.
void BodyPoint::violations(const BodyRows& rows, std::span<const Index> listed, double* out) const {
  for (std::size_t begin = 0; begin < listed.size(); begin += lanes::width) {
    const std::size_t count = std::min<std::size_t>(lanes::width, listed.size() - begin);
    std::array<lanes::Pack, lanes::width> high, low;
    high.fill(lanes::Pack(0));
    low.fill(lanes::Pack(0));
    Sum left;
    Lanes size = Lanes::Ones();
    for (std::size_t l = 0; l < count; ++l) {
      const Index i = listed[begin + l];
      const auto [first, second] = rows.body[at(i)];
      Sum sum;
      sum.add_product(rows.own_part(i, 0), z_.col(first), z_rest_.col(first));
      if (second >= 0) sum.add_product(rows.own_part(i, 1), z_.col(second), z_rest_.col(second));
      high[l] = lanes::Pack::load(sum.high.data());
      low[l] = lanes::Pack::load(sum.low.data());
      left.high[static_cast<Index>(l)] = rows.c[i];
      size[static_cast<Index>(l)] = unit_ * rows.row_norm[i];
    }
    lanes::transpose(high);
    lanes::transpose(low);
    for (std::size_t k = 0; k < 6; ++k) {
      left.add(-lanes::at(high[k].data(), 0));
      left.low -= lanes::at(low[k].data(), 0);
    }
    const Lanes all = (left.high + left.low).cwiseQuotient(size);
    std::copy_n(all.data(), count, out + begin);
  }
}

void BodyPoint::add_rows(const BodyRows& rows, std::span<const Index> listed, double* out) {
  violations(rows, listed, out);
  for (const Index i : listed) {
    const Lanes own = Lanes::Constant(lambda_[i]), own_rest = Lanes::Constant(lambda_rest_[i]);
    for (int side = 0; side < 2; ++side) {
      const int b = rows.body[at(i)][at(side)];
      if (b < 0) continue;
      Sum sum{force_.col(b), force_rest_.col(b)};
      sum.add_product(rows.own_part(i, side), own, own_rest);
      force_.col(b) = sum.high;
      force_rest_.col(b) = sum.low;
    }
  }
}

void BodyPoint::whiten_force(const BodyRows& rows, Motion& rho) const {
  const double unit = 1 / unit_;
  for (Index b = 0; b < rows.bodies(); ++b)
    rho.col(b) = BodyRows::times(rows.mass[at(b)].L_inverse, unit * (force_.col(b) + force_rest_.col(b)));
}

double BodyPoint::violation(const BodyRows& rows, Index i) const {
  double own = 0;
  violations(rows, {&i, 1}, &own);
  return own;
}

double BodyPoint::terms(const BodyRows& rows, Index i) const {
  const auto [first, second] = rows.body[at(i)];
  double sum = std::abs(rows.c[i]) + rows.own_part(i, 0).cwiseAbs().dot(z_.col(first).cwiseAbs());
  if (second >= 0) sum += rows.own_part(i, 1).cwiseAbs().dot(z_.col(second).cwiseAbs());
  return sum / (unit_ * rows.row_norm[i]);
}

void BodyPoint::write(const BodyRows& rows, Vector& z, Vector& lambda) const {
  z = (z_ + z_rest_).topRows<6>().reshaped();
  for (Index i = 0; i < rows.rows(); ++i) lambda[rows.row[at(i)]] = lambda_[i] + lambda_rest_[i];
}

}  // namespace zwang
