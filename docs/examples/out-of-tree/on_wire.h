#pragma once

#include <zwang/core/model/constraint.h>

// A point of body A stays on a straight line of body B: its distance from the line across two directions is zero [m].
struct OnWire {
  static constexpr auto name = "on_wire";
  static constexpr int rows = 2;
  static constexpr zwang::RowKind kind = zwang::RowKind::equality;
  std::array<zwang::BodyId, 2> bodies = {};
  zwang::Vec3 point = zwang::Vec3::Zero();                                       // m, in A's axes
  zwang::Vec3 start = zwang::Vec3::Zero();                                       // m, in B's axes
  zwang::Vec3 across = zwang::Vec3::UnitY(), across_too = zwang::Vec3::UnitZ();  // in B's axes, orthonormal

  template <class T>
  zwang::Vec<T, 2> value(const zwang::Pose<T>& a, const zwang::Pose<T>& b) const {
    const zwang::Vec<T, 3> apart = a * point - b * start;
    return zwang::Vec<T, 2>(b.turn(across).dot(apart), b.turn(across_too).dot(apart));
  }
};
static_assert(zwang::Constraint<OnWire>);
