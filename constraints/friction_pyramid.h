#pragma once

#include <zwang/constraints/contact.h>

namespace zwang {

// A contact with friction, as the convex relaxation of Coulomb's law (Anitescu, Math. Program. 105, 2006): instead of
// the one row n there are four, one per edge e of a pyramid inside the friction cone,
//
//   e . (r_A - r_B) >= 0,   e = n + mu t_1, n - mu t_1, n + mu t_2, n - mu t_2.
//
// Nothing but inequality rows, so every solver takes it. Their multipliers add up to the contact force sum lambda_e e,
// whose tangential part is at most mu times its normal part (in the pyramid's sense: |f_1| + |f_2| <= mu f_n); they
// resist sliding up to that bound, then let go. The price of convexity: a sliding contact separates, gap' = mu |v_t|,
// and the pyramid's corners favour two directions. With mu = 0 all four rows are Contact's. The tangential part of the
// value counts from r_B: build the contact anew in every step (contact_at), or it acts as a spring back to r_B.
struct FrictionPyramid : Contact {
  static constexpr auto name = "friction_pyramid";
  static constexpr int rows = 4;

  template <class T>
  Vec<T, 4> value(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> apart = a * point_a - b * point_b;
    Vec<T, 4> v;
    for (int k = 0; k < 4; ++k) v[k] = b.turn(edge(k)).dot(apart);
    return v;
  }

  Mat<double, 4, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    Mat<double, 4, 12> J;
    for (int k = 0; k < 4; ++k) J.row(k) = row::separation(b.turn(edge(k)), a * point_a, a.position, b.position);
    return J;
  }

 private:
  Vec3 edge(int k) const { return frame.col(0) + (k % 2 ? -friction : friction) * frame.col(1 + k / 2); }
};
static_assert(Constraint<FrictionPyramid> && HasJacobian<FrictionPyramid>);

}  // namespace zwang
