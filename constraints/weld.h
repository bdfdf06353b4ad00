#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// Two bodies become one: the anchors coincide [m] and B keeps the rotation `relative` in A's axes [sines].
struct Weld {
  static constexpr auto name = "weld";
  static constexpr int rows = 6;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};
  Vec3 anchor_a = Vec3::Zero(), anchor_b = Vec3::Zero();  // m, each in its body's axes
  Mat3 relative = Mat3::Identity();

  template <class T>
  Vec<T, 6> value(const Pose<T>& a, const Pose<T>& b) const {
    const Mat<T, 3, 3> kept = a.rotation * relative.cast<T>();
    Vec<T, 6> v;
    v << Vec<T, 3>(a * anchor_a - b * anchor_b), row::turn<T>(kept, b.rotation);
    return v;
  }

  Mat<double, 6, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    Mat<double, 6, 12> J;
    J << row::anchors(a, b, anchor_a, anchor_b), row::turn_jacobian(a.rotation * relative, b.rotation);
    return J;
  }
};
static_assert(Constraint<Weld> && HasJacobian<Weld>);

}  // namespace zwang
