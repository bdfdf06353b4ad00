#pragma once

#include <Eigen/Geometry>
#include <span>

#include <zwang/core/problem/types.h>

#include <unsupported/Eigen/AutoDiff>

namespace zwang {

// Rigid placement of a body: a point p of the body sits at rotation * p + position in the world.
template <class T>
struct Pose {
  Vec<T, 3> position = Vec<T, 3>::Zero();            // m, of the centre of mass
  Mat<T, 3, 3> rotation = Mat<T, 3, 3>::Identity();  // body to world

  Vec<T, 3> operator*(const Vec3& p) const {
    const Vec<T, 3> local = p.cast<T>();
    return rotation * local + position;
  }
  // A direction of the body, in the world.
  Vec<T, 3> turn(const Vec3& d) const {
    const Vec<T, 3> local = d.cast<T>();
    return rotation * local;
  }
};

using PoseSpan = std::span<const Pose<double>>;

// A part's pose, given in the axes of what it is `on`, in the world.
inline Pose<double> placed(const Pose<double>& on, const Pose<double>& part) {
  return {on * part.position, on.rotation * part.rotation};
}

// skew(a) * b = a x b.
template <class T>
Mat<T, 3, 3> skew(const Vec<T, 3>& a) {
  Mat<T, 3, 3> S;
  S << T(0), -a.z(), a.y(), a.z(), T(0), -a.x(), -a.y(), a.x(), T(0);
  return S;
}

// A scalar that carries N derivatives, numbers of type S each.
template <int N, class S = double>
using Dual = Eigen::AutoDiffScalar<Vec<S, N>>;

// The pose under an infinitesimal twist [linear; angular] (world axes, about the body's centre of mass) whose six
// components are the derivative directions offset .. offset + 5.
template <int N, class S>
Pose<Dual<N, S>> seed(const Pose<S>& q, int offset) {
  Pose<Dual<N, S>> out;
  for (int k = 0; k < 3; ++k) out.position[k] = Dual<N, S>(q.position[k], N, offset + k);
  for (int j = 0; j < 3; ++j) {
    const Vec<S, 3> axis = q.rotation.col(j);
    for (int i = 0; i < 3; ++i) {
      out.rotation(i, j) = Dual<N, S>(q.rotation(i, j), Vec<S, N>::Zero());
      for (int k = 0; k < 3; ++k) out.rotation(i, j).derivatives()[offset + 3 + k] = Vec<S, 3>::Unit(k).cross(axis)[i];
    }
  }
  return out;
}

// The pose after the twist `step` [m; rad] (world axes): rotations advance by the exponential map.
template <class T>
Pose<T> retract(const Pose<T>& q, const Vec<T, 6>& step) {
  using std::cos, std::sin, std::sqrt;
  const Vec<T, 3> w = step.template tail<3>();
  const T angle2 = w.squaredNorm(), angle = sqrt(angle2);
  // sin(a)/a and (1 - cos(a))/a^2 = 2 sin^2(a/2)/a^2, by their series where the quotients lose digits.
  const bool small = angle2 < T(1e-60);
  const T half = angle / T(2), sin_half = sin(half);
  const T s = small ? T(1) - angle2 / T(6) : T(sin(angle) / angle);
  const T v = small ? T(0.5) : T(T(2) * sin_half * sin_half / angle2);
  const Mat<T, 3, 3> W = skew(w);
  const Mat<T, 3, 3> R = Mat<T, 3, 3>::Identity() + W * s + W * W * v;
  return {q.position + step.template head<3>(), R * q.rotation};
}

// The rotation vector of R, of length at most pi: R = exp([w]x). By way of the quaternion, with its largest component
// as the pivot (Shepperd 1978): accurate at every angle, while the trace alone loses half the digits near 0 and pi.
template <class T>
Vec<T, 3> rotation_vector(const Mat<T, 3, 3>& R) {
  using std::atan2, std::sqrt;
  Vec<T, 3> v(T(R(2, 1) - R(1, 2)), T(R(0, 2) - R(2, 0)), T(R(1, 0) - R(0, 1)));
  const T trace = R.trace();
  T w = trace + T(1);  // up to a common factor, [w; v] is the quaternion
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (R(i, i) > R(k, k)) k = i;
  if (R(k, k) > trace) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    w = v[k];
    v[k] = T(1) + R(k, k) - R(i, i) - R(j, j);
    v[i] = R(i, k) + R(k, i);
    v[j] = R(j, k) + R(k, j);
  }
  const T sign = w < T(0) ? T(-1) : T(1);
  const T x2 = v.squaredNorm() / (w * w);
  // 2 atan(x) / x by its series where the root of x2 has no derivative.
  if (x2 < T(1e-6)) return v * T((T(2) - x2 * (T(2) / T(3) - x2 * (T(2) / T(5) - x2 * T(2) / T(7)))) / w);
  const T length = sqrt(v.squaredNorm());
  return v * T(T(2) * sign * atan2(length, T(sign * w)) / length);
}

// The twist that takes one pose to another: retract(from, twist_between(from, to)) = to.
template <class T>
Vec<T, 6> twist_between(const Pose<T>& from, const Pose<T>& to) {
  Vec<T, 6> twist;
  twist.template head<3>() = to.position - from.position;
  twist.template tail<3>() = rotation_vector<T>(to.rotation * from.rotation.transpose());
  return twist;
}

}  // namespace zwang
