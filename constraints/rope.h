#pragma once

#include <zwang/constraints/distance.h>

namespace zwang {

// Two anchors stay within a length of each other: length - |p_A - p_B| >= 0 [m]: a Distance that may go slack, with the
// same limit gradient, sign reversed, where the anchors coincide.
struct Rope : Distance {
  static constexpr auto name = "rope";
  static constexpr RowKind kind = RowKind::inequality;

  template <class T>
  Vec<T, 1> value(const Pose<T>& a, const Pose<T>& b) const {
    return -Distance::value(a, b);
  }
  Mat<double, 1, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const { return -Distance::jacobian(a, b); }
};
static_assert(Constraint<Rope> && HasJacobian<Rope>);

}  // namespace zwang
