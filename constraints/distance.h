#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// Two anchors stay a length apart: |p_A - p_B| - length = 0 [m]. Where the anchors coincide the norm has no gradient,
// and a zero row could never be met; jacobian() then takes the limit of the gradient as A's anchor comes in along B's
// x axis.
struct Distance {
  static constexpr auto name = "distance";
  static constexpr int rows = 1;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero(), anchor_b = Vec3::Zero();  // m, each in its body's axes
  double length = 1;                                      // m

  template <class T>
  Vec<T, 1> value(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> apart = a * anchor_a - b * anchor_b;
    return Vec<T, 1>(T(apart.norm() - T(length)));
  }

  Mat<double, 1, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    const Vec3 apart = a * anchor_a - b * anchor_b;
    const Vec3 direction = apart.isZero(0) ? b.turn(Vec3::UnitX()) : apart.stableNormalized();
    return direction.transpose() * row::anchors(a, b, anchor_a, anchor_b);
  }
};
static_assert(Constraint<Distance> && HasJacobian<Distance>);

}  // namespace zwang
