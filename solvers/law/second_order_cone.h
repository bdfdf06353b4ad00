#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/core/problem/types.h>

// The second-order cone L = {x : x_0 >= |(x_1, x_2)|} and its Jordan algebra (Alizadeh & Goldfarb 2003, Math. Program.
// 95). x points to three numbers.
namespace zwang::second_order_cone {

inline double tangential(const double* x) { return std::sqrt(x[1] * x[1] + x[2] * x[2]); }
inline double smallest(const double* x) { return x[0] - tangential(x); }
inline double largest(const double* x) { return x[0] + tangential(x); }
inline double determinant(const double* x) {
  const double t = tangential(x);
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

// Nesterov-Todd scaling of y and w inside L: W = eta (2 a a' - J)^(1/2) with W y = W^-1 w (Vandenberghe 2010, "The
// CVXOPT linear and quadratic cone program solvers", section 4.2).
struct Scaling {
  double a0, a1, a2, eta, inverse_eta, share;  // share: 1 / (1 + a_0)

  // For y or w outside L: not inside().
  static Scaling of(const double* y, const double* w) {
    const double size_y = std::sqrt(determinant(y)), size_w = std::sqrt(determinant(w));
    const double ry = 1 / size_y, rw = 1 / size_w;
    const double inner = (y[0] * w[0] + y[1] * w[1] + y[2] * w[2]) * ry * rw;
    const double f = 0.5 / std::sqrt(0.5 * (1 + inner)), a0 = (w[0] * rw + y[0] * ry) * f;
    const double eta = std::sqrt(size_w * ry);
    return {a0, (w[1] * rw - y[1] * ry) * f, (w[2] * rw - y[2] * ry) * f, eta, 1 / eta, 1 / (1 + a0)};
  }
  bool inside() const { return a0 > 0 && eta > 0 && inverse_eta > 0; }
  Vec3 times(const double* x) const {
    const double d = a1 * x[1] + a2 * x[2], f = x[0] + d * share;
    return {eta * (a0 * x[0] + d), eta * (x[1] + a1 * f), eta * (x[2] + a2 * f)};
  }
  Vec3 inverse_times(const double* x) const {
    const double d = a1 * x[1] + a2 * x[2], f = d * share - x[0];
    return {inverse_eta * (a0 * x[0] - d), inverse_eta * (x[1] + a1 * f), inverse_eta * (x[2] + a2 * f)};
  }
  // W^-2, by columns.
  void weight(double* D) const {
    const double r = inverse_eta * inverse_eta, b1 = -a1, b2 = -a2;
    D[0] = r * (2 * a0 * a0 - 1);
    D[4] = r * (2 * b1 * b1 + 1);
    D[8] = r * (2 * b2 * b2 + 1);
    D[1] = D[3] = r * 2 * a0 * b1;
    D[2] = D[6] = r * 2 * a0 * b2;
    D[5] = D[7] = r * 2 * b1 * b2;
  }
};

// x o y, and the x with l o x = r.
inline Vec3 product(const Vec3& x, const Vec3& y) {
  return {x.dot(y), x[0] * y[1] + y[0] * x[1], x[0] * y[2] + y[0] * x[2]};
}
inline Vec3 quotient(const Vec3& l, const Vec3& r) {
  const double x0 = (l[0] * r[0] - l[1] * r[1] - l[2] * r[2]) / determinant(l.data()), share = 1 / l[0];
  return {x0, (r[1] - l[1] * x0) * share, (r[2] - l[2] * x0) * share};
}

}  // namespace zwang::second_order_cone
