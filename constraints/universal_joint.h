#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// A cross of two axes: the anchors coincide [m], and the axis of A stays at a right angle to the axis of B [sine].
// Two rotational freedoms remain: about axis_a and about axis_b. The paper's palm-finger joint.
struct UniversalJoint {
  static constexpr auto name = "universal_joint";
  static constexpr int rows = 4;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero(), anchor_b = Vec3::Zero();  // m, each in its body's axes
  Vec3 axis_a = Vec3::UnitX(), axis_b = Vec3::UnitY();    // unit, each in its body's axes

  template <class T>
  Vec<T, 4> value(const Pose<T>& a, const Pose<T>& b) const {
    Vec<T, 4> v;
    v << Vec<T, 3>(a * anchor_a - b * anchor_b), a.turn(axis_a).dot(b.turn(axis_b));
    return v;
  }

  Mat<double, 4, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    Mat<double, 4, 12> J;
    J << row::anchors(a, b, anchor_a, anchor_b), row::alignment(a.turn(axis_a), b.turn(axis_b));
    return J;
  }
};
static_assert(Constraint<UniversalJoint> && HasJacobian<UniversalJoint>);

}  // namespace zwang
