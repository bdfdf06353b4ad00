#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <zwang/core/model/scene_change.h>

// What every constraint has to satisfy. check(constraint) is for a program of your own (docs/tutorials/
// write-a-constraint.md; needs Boost's headers); conformance_test.cpp asks the same of the project's constraints.
namespace zwang::conformance {

// Differences are taken in 100 digits with a step of 1e-30: their own error is below 1e-50, so what is left is the
// constraint's. In double they would be blind at 1e6 and at 1e-12.
using Big = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

template <class T>
using Poses = std::vector<Pose<T>>;

// A constraint without its type, so that the checks are compiled once and not for each.
struct Subject {
  struct Linear {
    Vector value;
    Matrix jacobian;  // d value / d twist: 6 columns a body
  };

  std::string name;
  RowKind kind;
  Index rows, bodies;
  bool has_jacobian;
  std::function<Linear(const Poses<double>&)> linearize, differentiate;
  std::function<Matrix(const Poses<double>&, const Vector&)> changing;  // of the Jacobian, along a twist of the bodies
  std::function<VectorX<Big>(const Poses<Big>&)> exact;

  template <Constraint C>
  Subject(const C& c)
      : name(C::name),
        kind(C::kind),
        rows(C::rows),
        bodies(arity<C>),
        has_jacobian(HasJacobian<C>),
        linearize([c](const Poses<double>& q) { return linear(zwang::linearize(c, fixed<C>(q))); }),
        differentiate([c](const Poses<double>& q) { return linear(zwang::differentiate(c, fixed<C>(q))); }),
        changing([c](const Poses<double>& q, const Vector& twist) -> Matrix {
          std::array<Pose<moving::Number>, static_cast<std::size_t>(arity<C>)> at;
          for (std::size_t b = 0; b < at.size(); ++b)
            at[b] = moving::pose(q[b], twist.segment<6>(6 * static_cast<Index>(b)));
          return moving::linear<C::rows>([&](const auto& poses) { return evaluate(c, poses); }, at).jacobian;
        }),
        exact([c](const Poses<Big>& q) -> VectorX<Big> { return evaluate(c, fixed<C>(q)); }) {}

 private:
  template <class C, class T>
  static PosesOf<C, T> fixed(const Poses<T>& q) {
    PosesOf<C, T> out;
    std::ranges::copy(q, out.begin());
    return out;
  }
  template <class C>
  static Linear linear(const Linearization<C>& l) {
    return {l.value, l.jacobian};
  }
};

inline Pose<double> random_pose(double reach) {
  const Vec<double, 6> twist = Vec<double, 6>::Random() * 2;
  Pose<double> q = retract(Pose<double>{}, twist);
  q.position *= reach / 2;
  return q;
}

inline Poses<double> random_poses(Index bodies, double reach) {
  Poses<double> q(static_cast<std::size_t>(bodies));
  for (auto& pose : q) pose = random_pose(reach);
  return q;
}

template <class T>
Poses<T> moved(const Poses<T>& q, const VectorX<T>& step) {
  Poses<T> out(q.size());
  for (std::size_t b = 0; b < q.size(); ++b)
    out[b] = retract<T>(q[b], step.template segment<6>(6 * static_cast<Index>(b)));
  return out;
}

// The smallest step that brings the linearized value to zero.
inline Vector correction(const Subject& c, const Poses<double>& q) {
  const auto linear = c.linearize(q);
  return linear.jacobian.completeOrthogonalDecomposition().solve(-linear.value);
}

// Poses at which the value is about `distance` away from zero.
inline Poses<double> nearly_satisfied(const Subject& c, double distance) {
  Poses<double> q = random_poses(c.bodies, 2);
  for (int k = 0; k < 100; ++k) q = moved(q, correction(c, q));
  const Vector away = Vector::Random(6 * c.bodies) * distance;
  return moved(q, away);
}

inline Poses<Big> exactly(const Poses<double>& q) {
  Poses<Big> exact;
  for (const auto& pose : q) exact.push_back({pose.position.cast<Big>(), pose.rotation.cast<Big>()});
  return exact;
}

inline MatrixX<Big> central_differences(const Subject& c, const Poses<Big>& q) {
  const Big h("1e-30");
  MatrixX<Big> J(c.rows, 6 * c.bodies);
  for (Index k = 0; k < J.cols(); ++k) {
    VectorX<Big> step = VectorX<Big>::Zero(J.cols());
    step[k] = h;
    const VectorX<Big> ahead = c.exact(moved(q, step));
    step[k] = -h;
    J.col(k) = (ahead - c.exact(moved(q, step))) / (2 * h);
  }
  return J;
}
inline Matrix central_differences(const Subject& c, const Poses<double>& q) {
  return central_differences(c, exactly(q)).cast<double>();
}

// Of the Jacobian, along a twist of the bodies.
inline Matrix change_by_differences(const Subject& c, const Poses<double>& q, const Vector& twist) {
  const Big h("1e-20");
  const VectorX<Big> step = h * twist.cast<Big>();
  const Poses<Big> here = exactly(q);
  const MatrixX<Big> ahead = central_differences(c, moved(here, step)),
                     behind = central_differences(c, moved(here, VectorX<Big>(-step)));
  return MatrixX<Big>((ahead - behind) / (2 * h)).cast<double>();
}

// The largest difference of two Jacobians, relative to the row's largest entry (or 1), and the place where it is.
struct Difference {
  double relative = 0, found = 0, expected = 0;
  std::string place = "row 0, body a, linear x";
};

inline Difference compare(const Matrix& found, const Matrix& expected) {
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

inline std::vector<Poses<double>> configurations(const Subject& c, int count, double reach) {
  std::vector<Poses<double>> all;
  for (int k = 0; k < count; ++k) all.push_back(random_poses(c.bodies, reach));
  return all;
}

// Of the automatic derivatives, and of the constraint's own where it has some. A derivative that is not finite fails.
inline std::vector<Finding> derivatives(const Subject& c, const std::vector<Poses<double>>& configurations,
                                        const std::string& where) {
  Difference automatic, analytic, second;
  for (const auto& q : configurations) {
    const Matrix truth = central_differences(c, q);
    const Vector twist = Vector::Random(6 * c.bodies);
    const Matrix change = c.changing(q, twist);
    if (!change.allFinite()) second.relative = std::numeric_limits<double>::infinity();
    if (const Difference d = compare(change, change_by_differences(c, q, twist)); d.relative > second.relative)
      second = d;
    const auto keep_worse = [&](Difference& worst, const Matrix& J) {
      if (!J.allFinite()) worst.relative = std::numeric_limits<double>::infinity();
      if (const Difference d = compare(J, truth); d.relative > worst.relative) worst = d;
    };
    keep_worse(automatic, c.differentiate(q).jacobian);
    keep_worse(analytic, c.linearize(q).jacobian);
  }
  const std::string name = c.name + ".jacobian";
  std::vector<Finding> out = {
      {name, "automatic vs central differences, " + where, automatic.relative, tolerance, &automatic},
      {name, "its change with the poses, likewise, " + where, second.relative, tolerance, &second}};
  if (c.has_jacobian)
    out.emplace_back(name, "analytic vs central differences, " + where, analytic.relative, tolerance, &analytic);
  return out;
}

// Bodies 1 m and 1e6 m apart, and where the constraint is satisfied but for 1e-12.
inline std::vector<Finding> derivatives(const Subject& c) {
  std::vector<Finding> all = derivatives(c, configurations(c, 10, 2), "bodies 1 m apart");
  std::ranges::move(derivatives(c, configurations(c, 10, 2e6), "bodies 1e6 m apart"), std::back_inserter(all));
  std::vector<Poses<double>> near;
  for (int k = 0; k < 5; ++k) near.push_back(nearly_satisfied(c, 1e-12));
  std::ranges::move(derivatives(c, near, "values of 1e-12"), std::back_inserter(all));
  return all;
}

// Bodies on top of each other, half turns: where norms, angles and rotation vectors lose their gradients.
inline Finding finite(const Subject& c) {
  int lost = 0;
  for (const Vec3& half_turn : {Vec3(0, 0, 0), Vec3(M_PI, 0, 0), Vec3(0, M_PI, 0), Vec3(0, 0, M_PI)})
    for (const Pose<double>& first : {Pose<double>{}, random_pose(2)}) {
      Poses<double> q(static_cast<std::size_t>(c.bodies), first);
      Vec<double, 6> twist;
      twist << Vec3::Zero(), half_turn;
      q.back() = retract(first, twist);
      const auto linear = c.linearize(q);
      lost += !linear.value.allFinite() || !linear.jacobian.allFinite();
    }
  return {c.name + ".finite", "degenerate poses with a row that is not finite", 1. * lost, 0};
}

// The world turned and moved: an inequality's rows and values stay what they are, seen from the turned world; those of
// an equality may be mixed among themselves by a rotation (a ball joint's three rows are world axes), so that J'J, J'v
// and v'v stay.
inline Finding frames(const Subject& c) {
  double worst = 0;
  for (const auto& q : configurations(c, 10, 2)) {
    const Pose<double> world = random_pose(2);
    Poses<double> there;
    for (const auto& pose : q)
      there.push_back({world.rotation * pose.position + world.position, world.rotation * pose.rotation});
    const auto here = c.linearize(q);
    auto seen = c.linearize(there);
    for (Index k = 0; k < 2 * c.bodies; ++k)
      seen.jacobian.middleCols<3>(3 * k) = (seen.jacobian.middleCols<3>(3 * k) * world.rotation).eval();
    Matrix H(c.rows, 6 * c.bodies + 1), S(c.rows, 6 * c.bodies + 1);
    H << here.jacobian, here.value;
    S << seen.jacobian, seen.value;
    const Matrix change = c.kind == RowKind::inequality ? Matrix(S - H) : Matrix(S.transpose() * S - H.transpose() * H);
    worst = std::max(worst, change.cwiseAbs().maxCoeff() / std::max(1., H.squaredNorm()));
  }
  return {c.name + ".frames", "invariant under a rigid motion of the world", worst, tolerance};
}

// A short move along a row's gradient raises the value of an inequality; along the correction, it brings the value of
// an equality nearer to zero, by the part that was walked.
inline Finding sign(const Subject& c) {
  constexpr double part = 1e-6;
  double worst = 0;
  for (const auto& q : configurations(c, 10, 2)) {
    const auto linear = c.linearize(q);
    const auto after = [&](const Vector& along) { return c.linearize(moved(q, Vector(part * along))).value; };
    for (Index row = 0; row < c.rows; ++row) {
      const Vector along = linear.jacobian.row(row).transpose();
      if (c.kind == RowKind::inequality && along.norm() > 1e-3) {
        const double slope = (after(along)[row] - linear.value[row]) / (part * along.squaredNorm());
        worst = std::max(worst, std::abs(slope - 1));
      }
    }
    if (c.kind == RowKind::equality) {
      const double gone = linear.value.norm() - after(correction(c, q)).norm();
      worst = std::max(worst, std::abs(gone / (part * linear.value.norm()) - 1));
    }
  }
  return {c.name + ".sign",
          c.kind == RowKind::inequality ? "inequality: value >= 0 is allowed, row pushes toward it"
                                        : "equality: value = 0 is allowed, rows pull toward it",
          worst, 1e-3};
}

// All of these, from the same random poses each time. Prints a line a check and what is wrong; false: something is.
// `c` should hide nothing: points and directions with no zeros and no symmetry in them.
inline bool check(const Subject& c) {
  std::srand(1);
  std::vector<Finding> all = derivatives(c);
  for (const Finding& one : {finite(c), frames(c), sign(c)}) all.push_back(one);
  for (const Finding& one : all) std::puts(one.line.c_str());
  for (const Finding& one : all)
    if (!one.ok) std::puts(one.fault.c_str());
  return std::ranges::all_of(all, &Finding::ok);
}

}  // namespace zwang::conformance
