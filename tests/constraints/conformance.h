#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <zwang/core/model/constraint.h>
#include <zwang/core/problem/dense.h>

// What every constraint has to satisfy. check(constraint) is for a program of your own (docs/tutorials/
// write-a-constraint.md; needs Boost's headers); conformance_test.cpp asks the same of the project's constraints.
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

inline std::string both_values(const Difference& d) {
  std::ostringstream text;
  text.precision(17);
  text << "at " << d.place << " it gives " << d.found << ", the differences give " << d.expected;
  return text.str();
}

inline constexpr double tolerance = 1e-12;  // relative to the row's largest entry

// "rope.jacobian   automatic vs central differences: 2.1e-10 (worst: row 0, body b, angular y)   ok", and of a failed
// check what is wrong.
struct Finding {
  std::string line, fault = {};
  bool ok;

  Finding(const std::string& name, const std::string& what, double figure, double allowed,
          const Difference* difference = nullptr)
      : ok(figure <= allowed) {
    std::ostringstream text;
    text.precision(1);
    text << name << "   " << what << ": " << std::scientific << figure;
    if (difference) text << " (worst: " << difference->place << ")";
    text << (ok ? "   ok" : "   FAILED");
    line = text.str();
    if (!ok) fault = name + ": " + what + (difference ? ": " + both_values(*difference) : " is beyond what is allowed");
  }
};

template <class C>
std::vector<PosesOf<C, double>> configurations(int count, double reach) {
  std::vector<PosesOf<C, double>> all;
  for (int k = 0; k < count; ++k) all.push_back(random_poses<C>(reach));
  return all;
}

// Of the automatic derivatives, and of the constraint's own where it has some. A derivative that is not finite fails.
template <class C>
std::vector<Finding> derivatives(const C& c, const std::vector<PosesOf<C, double>>& configurations,
                                 const std::string& where) {
  Difference automatic, analytic;
  for (const auto& q : configurations) {
    const Jacobian<C> truth = central_differences(c, q);
    const auto keep_worse = [&](Difference& worst, const Jacobian<C>& J) {
      if (!J.allFinite()) worst.relative = std::numeric_limits<double>::infinity();
      if (const Difference d = compare(J, truth); d.relative > worst.relative) worst = d;
    };
    keep_worse(automatic, differentiate(c, q).jacobian);
    keep_worse(analytic, linearize(c, q).jacobian);
  }
  const std::string name = std::string(C::name) + ".jacobian";
  std::vector<Finding> out = {
      {name, "automatic vs central differences, " + where, automatic.relative, tolerance, &automatic}};
  if (HasJacobian<C>)
    out.emplace_back(name, "analytic vs central differences, " + where, analytic.relative, tolerance, &analytic);
  return out;
}

// Bodies 1 m and 1e6 m apart, and where the constraint is satisfied but for 1e-12.
template <class C>
std::vector<Finding> derivatives(const C& c) {
  std::vector<Finding> all = derivatives(c, configurations<C>(10, 2), "bodies 1 m apart");
  std::ranges::move(derivatives(c, configurations<C>(10, 2e6), "bodies 1e6 m apart"), std::back_inserter(all));
  std::vector<PosesOf<C, double>> near;
  for (int k = 0; k < 5; ++k) near.push_back(nearly_satisfied(c, 1e-12));
  std::ranges::move(derivatives(c, near, "values of 1e-12"), std::back_inserter(all));
  return all;
}

// Bodies on top of each other, half turns: where norms, angles and rotation vectors lose their gradients.
template <class C>
Finding finite(const C& c) {
  int lost = 0;
  for (const Vec3& half_turn : {Vec3(0, 0, 0), Vec3(M_PI, 0, 0), Vec3(0, M_PI, 0), Vec3(0, 0, M_PI)})
    for (const Pose<double>& first : {Pose<double>{}, random_pose(2)}) {
      PosesOf<C, double> q;
      q.fill(first);
      Vec<double, 6> twist;
      twist << Vec3::Zero(), half_turn;
      q.back() = retract(first, twist);
      const auto linear = linearize(c, q);
      lost += !linear.value.allFinite() || !linear.jacobian.allFinite();
    }
  return {std::string(C::name) + ".finite", "degenerate poses with a row that is not finite", 1. * lost, 0};
}

// The world turned and moved: an inequality's rows and values stay what they are, seen from the turned world; those of
// an equality may be mixed among themselves by a rotation (a ball joint's three rows are world axes), so that J'J, J'v
// and v'v stay.
template <class C>
Finding frames(const C& c) {
  double worst = 0;
  for (const auto& q : configurations<C>(10, 2)) {
    const Pose<double> world = random_pose(2);
    PosesOf<C, double> there;
    for (std::size_t b = 0; b < q.size(); ++b)
      there[b] = {world.rotation * q[b].position + world.position, world.rotation * q[b].rotation};
    const auto here = linearize(c, q);
    auto seen = linearize(c, there);
    for (int k = 0; k < 2 * arity<C>; ++k)
      seen.jacobian.template middleCols<3>(3 * k) =
          (seen.jacobian.template middleCols<3>(3 * k) * world.rotation).eval();
    Matrix H(C::rows, 6 * arity<C> + 1), S(C::rows, 6 * arity<C> + 1);
    H << here.jacobian, here.value;
    S << seen.jacobian, seen.value;
    const Matrix change =
        C::kind == RowKind::inequality ? Matrix(S - H) : Matrix(S.transpose() * S - H.transpose() * H);
    worst = std::max(worst, change.cwiseAbs().maxCoeff() / std::max(1., H.squaredNorm()));
  }
  return {std::string(C::name) + ".frames", "invariant under a rigid motion of the world", worst, tolerance};
}

// A short move along a row's gradient raises the value of an inequality; along the correction, it brings the value of
// an equality nearer to zero, by the part that was walked.
template <class C>
Finding sign(const C& c) {
  constexpr double part = 1e-6;
  double worst = 0;
  for (const auto& q : configurations<C>(10, 2)) {
    const auto linear = linearize(c, q);
    for (int row = 0; row < C::rows; ++row) {
      const Vec<double, 6 * arity<C>> along = linear.jacobian.row(row).transpose();
      if (C::kind == RowKind::inequality && along.norm() > 1e-3) {
        const auto after = evaluate(c, moved<C>(q, Vec<double, 6 * arity<C>>(part * along)));
        const double slope = (after[row] - linear.value[row]) / (part * along.squaredNorm());
        worst = std::max(worst, std::abs(slope - 1));
      }
    }
    if (C::kind == RowKind::equality) {
      const auto after = evaluate(c, moved<C>(q, Vector(part * correction(c, q))));
      worst = std::max(worst, std::abs((linear.value.norm() - after.norm()) / (part * linear.value.norm()) - 1));
    }
  }
  return {std::string(C::name) + ".sign",
          C::kind == RowKind::inequality ? "inequality: value >= 0 is allowed, row pushes toward it"
                                         : "equality: value = 0 is allowed, rows pull toward it",
          worst, 1e-3};
}

// All of these, from the same random poses each time. Prints a line a check and what is wrong; false: something is.
// `c` should hide nothing: points and directions with no zeros and no symmetry in them.
template <Constraint C>
bool check(const C& c) {
  std::srand(1);
  std::vector<Finding> all = derivatives(c);
  for (const Finding& one : {finite(c), frames(c), sign(c)}) all.push_back(one);
  for (const Finding& one : all) std::puts(one.line.c_str());
  for (const Finding& one : all)
    if (!one.ok) std::puts(one.fault.c_str());
  return std::ranges::all_of(all, &Finding::ok);
}

}  // namespace zwang::conformance
