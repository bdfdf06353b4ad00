#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <zwang/core/problem/types.h>

// The second-order cone L = {x : x_0 >= |(x_1, x_2)|} and its Jordan algebra (Alizadeh & Goldfarb 2003, Math. Program.
// 95). x points to three numbers; T is a double, or the same number of several cones (linalg/lanes.h).
namespace zwang::second_order_cone {

inline double root(double x) { return std::sqrt(x); }

template <class T>
[[gnu::always_inline]] inline T tangential(const T* x) {
  return root(x[1] * x[1] + x[2] * x[2]);
}
template <class T>
[[gnu::always_inline]] inline T smallest(const T* x) {
  return x[0] - tangential(x);
}
inline double largest(const double* x) { return x[0] + tangential(x); }
template <class T>
[[gnu::always_inline]] inline T determinant(const T* x) {
  const T t = tangential(x);
  return (x[0] - t) * (x[0] + t);
}

// The point of L nearest to x.
inline Vec3 projected(const Vec3& x) {
  const double t = std::sqrt(x[1] * x[1] + x[2] * x[2]);
  if (t <= x[0]) return x;
  if (t <= -x[0]) return Vec3::Zero();
  const double normal = 0.5 * (x[0] + t), share = normal / t;
  return {normal, x[1] * share, x[2] * share};
}

// The largest a with x + a d in L, for x inside.
inline double step_to_boundary(const double* x, const double* d) {
  const double a = d[0] * d[0] - d[1] * d[1] - d[2] * d[2], b = x[0] * d[0] - x[1] * d[1] - x[2] * d[2];
  const double c = determinant(x), root = b * b - a * c;
  double step = std::numeric_limits<double>::infinity();
  if (d[0] < 0) step = -x[0] / d[0];
  if (!(root >= 0)) return step;
  const double q = -(b + std::copysign(std::sqrt(root), b));
  if (const double first = c / q; q != 0 && first > 0) step = std::min(step, first);
  if (const double second = q / a; a != 0 && second > 0) step = std::min(step, second);
  return step;
}

template <class T>
using Three = std::array<T, 3>;

// Nesterov-Todd scaling of y and w inside L: W = eta (2 a a' - J)^(1/2) with W y = W^-1 w (Vandenberghe 2010, "The
// CVXOPT linear and quadratic cone program solvers", section 4.2).
template <class T>
struct Scaling {
  T a0, a1, a2, eta, inverse_eta, share;  // share: 1 / (1 + a_0)

  // For y or w outside L some of it is not positive.
  [[gnu::always_inline]] static Scaling of(const T* y, const T* w) {
    const T size_y = root(determinant(y)), size_w = root(determinant(w));
    const T ry = 1 / size_y, rw = 1 / size_w;
    const T inner = (y[0] * w[0] + y[1] * w[1] + y[2] * w[2]) * ry * rw;
    const T f = T(0.5) / root(T(0.5) * (T(1) + inner)), a0 = (w[0] * rw + y[0] * ry) * f;
    const T eta = root(size_w * ry);
    return {a0, (w[1] * rw - y[1] * ry) * f, (w[2] * rw - y[2] * ry) * f, eta, 1 / eta, 1 / (T(1) + a0)};
  }
  [[gnu::always_inline]] Three<T> times(const T* x) const {
    const T d = a1 * x[1] + a2 * x[2], f = x[0] + d * share;
    return {eta * (a0 * x[0] + d), eta * (x[1] + a1 * f), eta * (x[2] + a2 * f)};
  }
  [[gnu::always_inline]] Three<T> inverse_times(const T* x) const {
    const T d = a1 * x[1] + a2 * x[2], f = d * share - x[0];
    return {inverse_eta * (a0 * x[0] - d), inverse_eta * (x[1] + a1 * f), inverse_eta * (x[2] + a2 * f)};
  }
  // W^-2, by columns.
  [[gnu::always_inline]] std::array<T, 9> weight() const {
    const T r = inverse_eta * inverse_eta, twice = r * T(2), b1 = -a1, b2 = -a2;
    const T D1 = twice * a0 * b1, D2 = twice * a0 * b2, D5 = twice * b1 * b2;
    const T D0 = r * (T(2) * a0 * a0 - T(1)), D4 = r * (T(2) * b1 * b1 + T(1)), D8 = r * (T(2) * b2 * b2 + T(1));
    return {D0, D1, D2, D1, D4, D5, D2, D5, D8};
  }
};

// x o y, and the x with l o x = r.
template <class T>
[[gnu::always_inline]] inline Three<T> product(const Three<T>& x, const Three<T>& y) {
  return {x[0] * y[0] + (x[1] * y[1] + x[2] * y[2]), x[0] * y[1] + y[0] * x[1], x[0] * y[2] + y[0] * x[2]};
}
template <class T>
[[gnu::always_inline]] inline Three<T> quotient(const Three<T>& l, const Three<T>& r) {
  const T x0 = (l[0] * r[0] - l[1] * r[1] - l[2] * r[2]) / determinant(l.data()), share = 1 / l[0];
  return {x0, (r[1] - l[1] * x0) * share, (r[2] - l[2] * x0) * share};
}
// D x, D by columns.
template <class T>
[[gnu::always_inline]] inline Three<T> multiply(const std::array<T, 9>& D, const Three<T>& x) {
  Three<T> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = D[i] * x[0] + D[i + 3] * x[1] + D[i + 6] * x[2];
  return out;
}

}  // namespace zwang::second_order_cone
