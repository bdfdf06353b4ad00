#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

enum class Side : signed char { lower = 1, upper = -1 };

// One side of a joint's range: angle >= bound, or angle <= bound [rad]. The angle is that of B's `direction` about A's
// `axis`, counted from A's `zero` and measured in the plane across the axis:
//
//   value = side * angle from (zero turned by bound) to direction, in (-pi, pi], >= 0 within the range.
//
// Counting from the bound instead of from zero keeps the jump of the angle half a turn away from where the row works.
// A row is written only while the range is left (value < reach; reach = 0: violated). For the second angle of a
// universal joint swap the bodies. Nor is one written from `farthest` beyond the bound on: of a range wider than half a
// turn, that is where the other bound is nearer. Where the direction points along the axis the angle has no gradient;
// the row is then the limit for a direction that leaves the axis at a right angle to the bound: a turn about the axis.
struct JointLimit {
  static constexpr auto name = "joint_limit";
  static constexpr int rows = 1;
  static constexpr RowKind kind = RowKind::inequality;
  static constexpr double half_turn = 3.2;  // rad, and a little more
  std::array<BodyId, 2> bodies = {};
  Vec3 axis = Vec3::UnitX(), zero = Vec3::UnitY();  // unit, at a right angle, in A's axes
  Vec3 direction = Vec3::UnitY();                   // unit, in B's axes
  double bound = 0;                                 // rad
  Side side = Side::lower;
  double reach = 0;             // rad
  double farthest = half_turn;  // rad; this much: anywhere beyond the bound

  template <class T>
  Vec<T, 1> value(const Pose<T>& a, const Pose<T>& b) const {
    using std::atan2;
    const Vec<T, 3> from = a.turn(at_bound()), to = b.turn(direction);
    const T sine = a.turn(axis).dot(from.cross(to)), cosine = from.dot(to);
    return Vec<T, 1>(T(T(static_cast<int>(side)) * atan2(sine, cosine)));
  }

  // Without reach the sine decides: the arcus tangent of forty limits would take a third of a hand's assembly.
  bool active(const Pose<double>& a, const Pose<double>& b) const {
    if (reach != 0 || farthest < half_turn) {
      const double within = value(a, b)[0];
      return within < reach && within > -farthest;
    }
    const double sine = a.turn(axis.cross(at_bound())).dot(b.turn(direction));
    return sine == 0 ? value(a, b)[0] < 0 : static_cast<int>(side) * sine < 0;
  }

  // rad, how far the direction is beyond the bound.
  double beyond(const Pose<double>& a, const Pose<double>& b) const {
    const double by = -value(a, b)[0];
    return by > 0 && by < farthest ? by : 0;
  }

  Mat<double, 1, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    const Vec3 n = a.turn(axis), from = a.turn(at_bound()), to = b.turn(direction), across = n.cross(from);
    const double sine = across.dot(to), cosine = from.dot(to), square = sine * sine + cosine * cosine;
    Vec3 turning = n;
    if (square > 0) turning = (cosine * to.cross(across) - sine * to.cross(from)) / square;
    turning *= static_cast<int>(side);
    Mat<double, 1, 12> J;
    J << 0, 0, 0, -turning.transpose(), 0, 0, 0, turning.transpose();
    return J;
  }

 private:
  Vec3 at_bound() const { return std::cos(bound) * zero + std::sin(bound) * axis.cross(zero); }
};
static_assert(Constraint<JointLimit> && HasJacobian<JointLimit> && HasActive<JointLimit>);

}  // namespace zwang
