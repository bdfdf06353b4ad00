#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// A slider: A's anchor stays on a line of B [two rows, m] and A does not turn against B [three rows, sines]. One
// freedom remains: along the axis. `relative` is the rotation of B in A's axes to be kept.
struct PrismaticJoint {
  static constexpr auto name = "prismatic_joint";
  static constexpr int rows = 5;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero(), anchor_b = Vec3::Zero();  // m, each in its body's axes
  Vec3 axis_b = Vec3::UnitX();                            // unit, in B's axes
  Mat3 relative = Mat3::Identity();

  template <class T>
  Vec<T, 5> value(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> apart = a * anchor_a - b * anchor_b;
    const Vec3 across = axis_b.unitOrthogonal();
    const Mat<T, 3, 3> kept = a.rotation * relative.cast<T>();
    Vec<T, 5> v;
    v << b.turn(across).dot(apart), b.turn(axis_b.cross(across)).dot(apart), row::turn<T>(kept, b.rotation);
    return v;
  }

  Mat<double, 5, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    const Vec3 across = axis_b.unitOrthogonal(), r_a = a * anchor_a;
    const auto along = [&](const Vec3& e) { return row::separation(b.turn(e), r_a, a.position, b.position); };
    Mat<double, 5, 12> J;
    J << along(across), along(axis_b.cross(across)), row::turn_jacobian(a.rotation * relative, b.rotation);
    return J;
  }
};
static_assert(Constraint<PrismaticJoint> && HasJacobian<PrismaticJoint>);

}  // namespace zwang
