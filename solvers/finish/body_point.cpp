#include <zwang/solvers/finish/body_point.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/number/double_double.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

// As much of a body's eight lanes as one of the processor's vectors holds: sums of two stay in its registers then, and
// of all eight they would not.
using Part = lanes::PackOf<1>;
constexpr std::size_t side = Part::lanes;

// each(v) for the vectors of eight lanes, which begin at v.
template <class Each>
[[gnu::always_inline]] inline void over_parts(Each&& each) {
  lanes::unroll<lanes::width / side>([&](auto k) { each(std::integral_constant<std::size_t, k * side>{}); });
}

// a b - product, exactly.
[[gnu::always_inline]] inline Part error_of(const Part& product, const Part& a, const Part& b) {
#ifdef __FMA__
  return multiply_add(a, b, -product);
#else
  // Dekker's halves of 26 bits: fma() would be a call for each entry.
  constexpr double split = 0x1p27 + 1;
  const Part a_split = Part(split) * a, a_high = a_split - (a_split - a), a_low = a - a_high;
  const Part b_split = Part(split) * b, b_high = b_split - (b_split - b), b_low = b - b_high;
  return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
#endif
}

// high + low.
struct Sum {
  Part high{0.0}, low{0.0};

  static Sum load(const double* high, const double* low) { return {Part::load(high), Part::load(low)}; }
  void store(double* to_high, double* to_low) const {
    high.store(to_high);
    low.store(to_low);
  }
  // a (x + x_low).
  [[gnu::always_inline]] static Sum of_product(const Part& a, const Sum& x) {
    const Part product = a * x.high;
    return {product, error_of(product, a, x.high) + a * x.low};
  }
  [[gnu::always_inline]] void add(const Part& x) {
    const Part after = high + x, part = after - high;
    low += (high - (after - part)) + (x - part);
    high = after;
  }
  [[gnu::always_inline]] void add_product(const Part& a, const Sum& x) {
    const Sum product = of_product(a, x);
    low += product.low;
    add(product.high);
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
    const Lanes moved = unit_ * BodyRows::times(rows.mass[at(b)].L_inverse_t, step.col(b));
    double *const high = z_.col(b).data(), *const low = z_rest_.col(b).data();
    over_parts([&](auto v) {
      Sum own = Sum::load(high + v, low + v);
      own.add(Part::load(moved.data() + v));
      own.store(high + v, low + v);
    });
  }
}

void BodyPoint::push(const BodyRows& rows, std::span<const Index> listed, const double* unit) {
  for (const Index i : listed) {
    const double step = unit_ * (*unit++ / rows.row_norm[i]);
    const DoubleDouble sum = DoubleDouble::exact_sum(lambda_[i], step);
    lambda_[i] = sum.hi;
    lambda_rest_[i] += sum.lo;
  }
}

void BodyPoint::begin_force(const BodyRows& rows) {
  force_.resize(BodyRows::lanes, rows.bodies());
  force_rest_.resize(BodyRows::lanes, rows.bodies());
  for (Index b = 0; b < rows.bodies(); ++b) {
    std::array<double, lanes::width> high, low;  // of z_u - z
    over_parts([&](auto v) {
      Sum d{Part::load(rows.z_u.col(b).data() + v), -Part::load(z_rest_.col(b).data() + v)};
      d.add(-Part::load(z_.col(b).data() + v));
      d.store(&high[v], &low[v]);
    });
    const double* const M = rows.mass[at(b)].M.data();
    over_parts([&](auto v) {
      Sum sum = Sum::of_product(Part::load(M + v), {Part(high[0]), Part(low[0])});
      for (std::size_t c = 1; c < 6; ++c)
        sum.add_product(Part::load(M + lanes::width * c + v), {Part(high[c]), Part(low[c])});
      sum.store(force_.col(b).data() + v, force_rest_.col(b).data() + v);
    });
  }
}

// The sums over the entries of eight rows side by side.
void BodyPoint::violations(const BodyRows& rows, std::span<const Index> listed, double* out) const {
  for (std::size_t begin = 0; begin < listed.size(); begin += lanes::width) {
    const std::size_t count = std::min<std::size_t>(lanes::width, listed.size() - begin);
    std::array<lanes::Pack, lanes::width> high, low;
    high.fill(lanes::Pack(0));
    low.fill(lanes::Pack(0));
    std::array<double, lanes::width> c{}, size;
    size.fill(1);
    for (std::size_t l = 0; l < count; ++l) {
      const Index i = listed[begin + l];
      const auto [first, second] = rows.body[at(i)];
      const double* const own = rows.own_part(i, 0).data();
      const auto z = [&](int b, std::size_t v) { return Sum::load(z_.col(b).data() + v, z_rest_.col(b).data() + v); };
      over_parts([&](auto v) {
        Sum sum = Sum::of_product(Part::load(own + v), z(first, v));
        if (second >= 0) sum.add_product(Part::load(own + lanes::width + v), z(second, v));
        sum.store(high[l].data() + v, low[l].data() + v);
      });
      c[l] = rows.c[i];
      size[l] = unit_ * rows.row_norm[i];
    }
    lanes::transpose(high);
    lanes::transpose(low);
    std::array<double, lanes::width> all;
    over_parts([&](auto v) {
      Sum left{Part::load(&c[v]), Part(0.0)};
      for (std::size_t k = 0; k < 6; ++k) {
        left.add(-Part::load(high[k].data() + v));
        left.low -= Part::load(low[k].data() + v);
      }
      ((left.high + left.low) / Part::load(&size[v])).store(&all[v]);
    });
    std::copy_n(all.data(), count, out + begin);
  }
}

// Rows between the same bodies mostly follow each other: their sums stay in registers meanwhile.
void BodyPoint::add_rows(const BodyRows& rows, std::span<const Index> listed, double* out) {
  violations(rows, listed, out);
  for (std::size_t begin = 0, end = 0; begin < listed.size(); begin = end) {
    const auto [first, second] = rows.body[at(listed[begin])];
    const auto is_same = [&](const std::array<int, 2>& b) { return b[0] == first && b[1] == second; };
    while (end < listed.size() && is_same(rows.body[at(listed[end])])) ++end;
    for (int which = 0; which < (second < 0 ? 1 : 2); ++which) {
      const int b = which == 0 ? first : second;
      double *const high = force_.col(b).data(), *const low = force_rest_.col(b).data();
      std::array<Sum, lanes::width / side> sum;
      over_parts([&](auto v) { sum[v / side] = Sum::load(high + v, low + v); });
      for (std::size_t k = begin; k < end; ++k) {
        const Sum multiplier{Part(lambda_[listed[k]]), Part(lambda_rest_[listed[k]])};
        const double* const own = rows.own_part(listed[k], which).data();
        over_parts([&](auto v) { sum[v / side].add_product(Part::load(own + v), multiplier); });
      }
      over_parts([&](auto v) { sum[v / side].store(high + v, low + v); });
    }
  }
}

void BodyPoint::whiten_force(const BodyRows& rows, Motion& rho) const {
  const double unit = 1 / unit_;
  for (Index b = 0; b < rows.bodies(); ++b)
    rho.col(b) = BodyRows::times(rows.mass[at(b)].L_inverse, unit * (force_.col(b) + force_rest_.col(b)));
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
