#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// A hinge: the anchors coincide [m], and the axis of A has no part along two directions of B that span the plane
// across its axis [sines]. One rotational freedom remains. (The rows also vanish with the axes opposed, half a turn
// off, which a joint does not reach within one step.)
struct RevoluteJoint {
  static constexpr auto name = "revolute_joint";
  static constexpr int rows = 5;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero(), anchor_b = Vec3::Zero();  // m, each in its body's axes
  Vec3 axis_a = Vec3::UnitX(), axis_b = Vec3::UnitX();    // unit, each in its body's axes

  template <class T>
  Vec<T, 5> value(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> axis = a.turn(axis_a);
    const Vec3 across = axis_b.unitOrthogonal();
    Vec<T, 5> v;
    v << Vec<T, 3>(a * anchor_a - b * anchor_b), axis.dot(b.turn(across)), axis.dot(b.turn(axis_b.cross(across)));
    return v;
  }

  Mat<double, 5, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    const Vec3 axis = a.turn(axis_a), across = axis_b.unitOrthogonal();
    Mat<double, 5, 12> J;
    J << row::anchors(a, b, anchor_a, anchor_b), row::alignment(axis, b.turn(across)),
        row::alignment(axis, b.turn(axis_b.cross(across)));
    return J;
  }
};
static_assert(Constraint<RevoluteJoint> && HasJacobian<RevoluteJoint>);

}  // namespace zwang
