#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <sstream>
#include <string>

#include <zwang/core/model/constraint.h>
#include <zwang/core/problem/dense.h>

// What every constraint has to satisfy, for the shared test (conformance_test.cpp).
namespace zwang::conformance {

// Differences are taken in 100 digits with a step of 1e-30: their own error is below 1e-50, so what is left is the
// constraint's. In double they would be blind at 1e6 and at 1e-12.
using Big = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

template <class C>
using Jacobian = Mat<double, C::rows, 6 * arity<C>>;

inline Pose<double> random_pose(double reach) {
  const Vec<double, 6> twist = Vec<double, 6>::Random() * 2;
  Pose<double> q = retract(Pose<double>{}, twist);
  q.position *= reach / 2;
  return q;
}

template <class C>
PosesOf<C, double> random_poses(double reach) {
  PosesOf<C, double> q;
  for (auto& pose : q) pose = random_pose(reach);
  return q;
}

template <class C, class T, class Step>
PosesOf<C, T> moved(const PosesOf<C, T>& q, const Step& step) {
  PosesOf<C, T> out;
  for (std::size_t b = 0; b < q.size(); ++b)
    out[b] = retract<T>(q[b], step.template segment<6>(6 * static_cast<Index>(b)));
  return out;
}

// The smallest step that brings the linearized value to zero.
template <class C>
Vector correction(const C& c, const PosesOf<C, double>& q) {
  const auto linear = linearize(c, q);
  return least_norm_solution(Matrix(linear.jacobian), Vector(-linear.value));
}

// Poses at which the value is about `distance` away from zero.
template <class C>
PosesOf<C, double> nearly_satisfied(const C& c, double distance) {
  PosesOf<C, double> q = random_poses<C>(2);
  for (int k = 0; k < 100; ++k) q = moved<C>(q, correction(c, q));
  const Vec<double, 6 * arity<C>> away = Vec<double, 6 * arity<C>>::Random() * distance;
  return moved<C>(q, away);
}

template <class C>
Jacobian<C> central_differences(const C& c, const PosesOf<C, double>& q) {
  const Big h("1e-30");
  PosesOf<C, Big> exact;
  for (std::size_t b = 0; b < q.size(); ++b)
    exact[b] = {q[b].position.template cast<Big>(), q[b].rotation.template cast<Big>()};
  Jacobian<C> J;
  for (int k = 0; k < 6 * arity<C>; ++k) {
    const Vec<Big, 6 * arity<C>> step = Vec<Big, 6 * arity<C>>::Unit(k) * h, back = -step;
    const Vec<Big, C::rows> slope =
        (evaluate(c, moved<C, Big>(exact, step)) - evaluate(c, moved<C, Big>(exact, back))) / (2 * h);
    J.col(k) = slope.template cast<double>();
  }
  return J;
}

// The largest difference of two Jacobians, relative to the row's largest entry (or 1), and the place where it is.
struct Difference {
  double relative = 0, found = 0, expected = 0;
  std::string place = "row 0, body a, linear x";
};

template <class Mat>
Difference compare(const Mat& found, const Mat& expected) {
  static constexpr const char* axis[] = {"linear x", "linear y", "linear z", "angular x", "angular y", "angular z"};
  Difference worst;
  for (Index r = 0; r < found.rows(); ++r)
    for (Index k = 0; k < found.cols(); ++k) {
      const double scale = std::max(1., expected.row(r).cwiseAbs().maxCoeff());
      const double relative = std::abs(found(r, k) - expected(r, k)) / scale;
      if (relative <= worst.relative) continue;  // false for NaN
      worst = {relative, found(r, k), expected(r, k),
               "row " + std::to_string(r) + ", body " + "ab"[k / 6] + ", " + axis[k % 6]};
    }
  return worst;
}

// "rope.jacobian   automatic vs central differences: 2.1e-10 (worst: row 0, body b, angular y)   ok"
inline std::string line(const std::string& name, const std::string& what, double figure, bool ok,
                        const std::string& where = {}) {
  std::ostringstream text;
  text.precision(1);
  text << name << "   " << what << ": " << std::scientific << figure;
  if (!where.empty()) text << " (worst: " << where << ")";
  text << (ok ? "   ok" : "   FAILED");
  return text.str();
}

inline std::string both_values(const Difference& d) {
  std::ostringstream text;
  text.precision(17);
  text << "at " << d.place << " it gives " << d.found << ", the differences give " << d.expected;
  return text.str();
}

}  // namespace zwang::conformance
