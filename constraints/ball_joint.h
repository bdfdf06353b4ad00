#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// Two anchors coincide: p_A - p_B = 0 [m]. Three rotational freedoms remain.
struct BallJoint {
  static constexpr auto name = "ball_joint";
  static constexpr int rows = 3;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero();  // m, in A's axes
  Vec3 anchor_b = Vec3::Zero();  // m, in B's axes

  template <class T>
  Vec<T, 3> value(const Pose<T>& a, const Pose<T>& b) const {
    return a * anchor_a - b * anchor_b;
  }

  Mat<double, 3, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    return row::anchors(a, b, anchor_a, anchor_b);
  }
};
static_assert(Constraint<BallJoint> && HasJacobian<BallJoint>);

}  // namespace zwang
