#pragma once

#include <zwang/core/model/constraint.h>

namespace zwang::row {

// The few kinds of rows that the joints and contacts are made of: derivatives with respect to the twists of A and B,
// [linear; angular] each, world axes.

// Of q * p, a point with lever u = q * p - q.position: [I, -[u]x].
inline Mat<double, 3, 6> point(const Vec3& u) {
  Mat<double, 3, 6> J;
  J << Mat3::Identity(), -skew<double>(u);
  return J;
}

// Of p_A - p_B, anchors fixed in their bodies.
inline Mat<double, 3, 12> anchors(const Pose<double>& a, const Pose<double>& b, const Vec3& anchor_a,
                                  const Vec3& anchor_b) {
  Mat<double, 3, 12> J;
  J << point(a.turn(anchor_a)), -point(b.turn(anchor_b));
  return J;
}

// Of e . (r_A - r_B), where the direction e turns with B: [e, u x e] on A, [-e, -(u_B x e)] on B, both levers to r_A.
// With e = n this is Eq. 24, exact also where the two points are apart.
inline Mat<double, 1, 12> separation(const Vec3& e, const Vec3& r_a, const Vec3& center_a, const Vec3& center_b) {
  const Vec3 on_a = (r_a - center_a).cross(e), on_b = e.cross(r_a - center_b);
  Mat<double, 1, 12> J;
  J << e[0], e[1], e[2], on_a[0], on_a[1], on_a[2], -e[0], -e[1], -e[2], on_b[0], on_b[1], on_b[2];
  return J;
}

// Of d_A . d_B, directions fixed in their bodies (already in the world).
inline Mat<double, 1, 12> alignment(const Vec3& d_a, const Vec3& d_b) {
  const Vec3 g = d_a.cross(d_b);
  Mat<double, 1, 12> J;
  J << 0, 0, 0, g.transpose(), 0, 0, 0, -g.transpose();
  return J;
}

// How far B is turned away from A: sin(angle) times the axis of R_B R_A', as 1/2 sum_i a_i x b_i over the axes of both.
// Polynomial, so smooth everywhere; zero also after half a turn, which a joint does not make within one step.
template <class T>
Vec<T, 3> turn(const Mat<T, 3, 3>& A, const Mat<T, 3, 3>& B) {
  Vec<T, 3> sum = Vec<T, 3>::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec<T, 3> a = A.col(i), b = B.col(i);
    sum += a.cross(b);
  }
  return sum / T(2);
}

inline Mat<double, 3, 12> turn_jacobian(const Mat3& A, const Mat3& B) {
  Mat3 on_a = Mat3::Zero();
  for (int i = 0; i < 3; ++i) on_a += skew<double>(B.col(i)) * skew<double>(A.col(i)) / 2;
  Mat<double, 3, 12> J;
  J << Mat3::Zero(), on_a, Mat3::Zero(), -on_a.transpose();
  return J;
}

}  // namespace zwang::row
