#pragma once

#include <btBulletDynamicsCommon.h>

#include <zwang/core/model/pose.h>

// Vectors and poses as Bullet has them, and back.
namespace zwang::god {

inline btVector3 vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 vector(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline btTransform transform(const Pose<double>& pose) {
  const Mat3& R = pose.rotation;
  const btMatrix3x3 basis(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
  return btTransform(basis, vector(pose.position));
}

inline Pose<double> pose_of(const btTransform& t) {
  Pose<double> pose{vector(t.getOrigin()), {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) pose.rotation(i, j) = t.getBasis()[i][j];
  return pose;
}

}  // namespace zwang::god
