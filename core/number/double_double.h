#pragma once

#ifdef __FAST_MATH__
#error "double-double arithmetic is wrong under -ffast-math: compile what includes it without"
#endif

#include <cmath>
#include <compare>
#include <concepts>
#include <limits>
#include <type_traits>

namespace zwang {

// A number as the unevaluated sum hi + lo of two doubles, |lo| <= ulp(hi) / 2: 106 bits, relative rounding error below
// 2^-102 per operation (Dekker 1971; the accurate sum and product of Joldes, Muller & Popescu 2017, algorithms 6 and
// 12), the range of double. Products of two doubles are exact. Needs IEEE arithmetic without contraction, which the
// build asks for.
struct DoubleDouble {
  double hi = 0, lo = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double value) : hi(value) {}
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
  explicit constexpr DoubleDouble(std::same_as<long double> auto value)
      : hi(static_cast<double>(value)), lo(static_cast<double>(value - hi)) {}
  explicit constexpr operator double() const { return hi; }
  explicit constexpr operator long double() const { return static_cast<long double>(hi) + lo; }

  DoubleDouble operator-() const { return {-hi, -lo}; }
  DoubleDouble scaled(int exponent) const { return {std::ldexp(hi, exponent), std::ldexp(lo, exponent)}; }
  DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
  DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this + -b; }
  DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }
  DoubleDouble& operator/=(const DoubleDouble& b) { return *this = *this / b; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble s = exact_sum(a.hi, b.hi), t = exact_sum(a.lo, b.lo);
    const DoubleDouble v = fast_sum(s.hi, s.lo + t.hi);
    return fast_sum(v.hi, t.lo + v.lo);
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = exact_product(a.hi, b.hi);
    return fast_sum(p.hi, p.lo + std::fma(a.hi, b.lo, a.lo * b.hi) + a.lo * b.lo);
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.hi / b.hi;
    const DoubleDouble left = a - b * first;
    const double second = left.hi / b.hi;
    return fast_sum(first, second) + (left - b * second).hi / b.hi;
  }
  friend DoubleDouble abs(const DoubleDouble& a) { return a.hi < 0 ? -a : a; }
  friend DoubleDouble sqrt(const DoubleDouble& a) {
    const double root = std::sqrt(a.hi);
    return a.hi > 0 ? fast_sum(root, (a - exact_product(root, root)).hi / (2 * root)) : DoubleDouble(root);
  }
  friend bool isfinite(const DoubleDouble& a) { return std::isfinite(a.hi); }
  friend DoubleDouble ldexp(const DoubleDouble& a, int exponent) { return a.scaled(exponent); }
  friend std::partial_ordering operator<=>(const DoubleDouble& a, const DoubleDouble& b) {
    return a.hi == b.hi ? a.lo <=> b.lo : a.hi <=> b.hi;
  }
  friend bool operator==(const DoubleDouble& a, const DoubleDouble& b) { return a.hi == b.hi && a.lo == b.lo; }

  // a + b and a * b without error (barring overflow; for the product also underflow).
  static DoubleDouble exact_sum(double a, double b) {
    const double s = a + b, part = s - a;
    return {s, (a - (s - part)) + (b - part)};
  }
  static DoubleDouble exact_product(double a, double b) {
    const double p = a * b;
    return {p, std::fma(a, b, -p)};
  }

 private:
  // exact_sum for |a| >= |b|.
  static DoubleDouble fast_sum(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
  }
};

// What the referee's factors are made of: x87's long double of 64 bits, and double-double where long double is another
// format (ZWANG_NO_X87 says so for tests). Either is wider than the doubles that are judged; residuals and decisions
// are in double-double on every machine.
#ifdef ZWANG_NO_X87
constexpr bool x87 = false;
#else
constexpr bool x87 = std::numeric_limits<long double>::digits == 64;
#endif
using FactorReal = std::conditional_t<x87, long double, DoubleDouble>;

}  // namespace zwang

template <>
struct std::numeric_limits<zwang::DoubleDouble> : std::numeric_limits<double> {
  static constexpr int digits = 102;
  static constexpr double epsilon() { return 0x1p-102; }
};
static_assert(std::numeric_limits<zwang::FactorReal>::digits >= 64, "the referee needs more than doubles");
