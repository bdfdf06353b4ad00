#pragma once

#include <zwang/constraints/rows.h>

namespace zwang {

// The virtual coupling of a god object A to its target B (Eq. 2), position and rotation vector stacked [m; rad]:
//
//   value = x_A - x_B = 0, each row soft.
//
// Eq. 2 has two readings, and the project has both. In the paper the coupling IS the unconstrained motion, z_u = k_s
// (x_target - x_god): no rows, every body pulled with its own mass as the weight; core/model/motion.h's
// couple_to_targets gives that z_u, and the god hand uses it. But then z_u has no room for gravity or other forces.
// This constraint is the other reading, a spring beside a z_u that is already taken: six equality rows of compliance
// 1/weight, which add 1/2 weight |J z - c|^2 per row to Gauss' function, c = k_s (x_target - x_god) with k_s = 1/dt^2.
// Infinitely stiff it is a weld to the target; with z_u = 0 and a weight w times the mass it reaches w/(1 + w) of Eq.
// 2's z_u. The target is a body of fixed or prescribed motion, so it has no columns, or a free one, which is then
// pulled back.
struct TargetCoupling {
  static constexpr auto name = "target_coupling";
  static constexpr int rows = 6;
  static constexpr RowKind kind = RowKind::equality;
  std::array<BodyId, 2> bodies = {};  // god object, target
  double linear_compliance = 1;       // (m/s^2)/N = 1/kg
  double angular_compliance = 1;      // (rad/s^2)/(N m) = 1/(kg m^2)

  template <class T>
  Vec<T, 6> value(const Pose<T>& god, const Pose<T>& target) const {
    return twist_between(target, god);
  }

  Vec<double, 6> compliance() const {
    Vec<double, 6> soft;
    soft << Vec3::Constant(linear_compliance), Vec3::Constant(angular_compliance);
    return soft;
  }

  // With w = log(R_A R_B'), a twist of A adds J_l^-1(w) and one of B subtracts J_l^-1(-w) = J_l^-1(w)', where
  // J_l^-1(w) = I - [w]x / 2 + (1 - (|w|/2) cot(|w|/2)) [w]x^2 / |w|^2 (Sola, Deray & Atchuthan 2018, Eq. 146).
  Mat<double, 6, 12> jacobian(const Pose<double>& god, const Pose<double>& target) const {
    const Vec3 w = twist_between(target, god).tail<3>();
    const double angle = w.norm(), half = angle / 2;
    const double k = angle < 1e-3 ? 1. / 12 + angle * angle / 720 : (1 - half / std::tan(half)) / (angle * angle);
    const Mat3 W = skew(w);
    const Mat3 on_god = Mat3::Identity() - W / 2 + k * W * W;
    Mat<double, 6, 12> J = Mat<double, 6, 12>::Zero();
    J.block<3, 3>(0, 0).setIdentity();
    J.block<3, 3>(0, 6) = -Mat3::Identity();
    J.block<3, 3>(3, 3) = on_god;
    J.block<3, 3>(3, 9) = -on_god.transpose();
    return J;
  }
};
static_assert(Constraint<TargetCoupling> && HasJacobian<TargetCoupling> && HasCompliance<TargetCoupling>);

}  // namespace zwang
