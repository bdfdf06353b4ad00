#pragma once

#include <zwang/constraints/rows.h>
#include <zwang/core/model/scene.h>

namespace zwang {

// A point of A stays outside a face of B (Eq. 23-24):
//
//   gap = n . (r_A - r_B) >= 0,   n from B to A.
//
// One type for every partner: a static obstacle is a fixed body, a moving one is prescribed or free; only free bodies
// have columns. The normal turns with B. The paper's row [n, u x n | -n, -(u_B x n)], both levers to r_A, is then the
// exact derivative, also for a gap that is not zero. With friction two tangent rows follow, for the slip of A over the
// face along t_1 and t_2: the same derivative with t in place of n.
struct Contact {
  static constexpr auto name = "contact";
  static constexpr int rows = 1;
  static constexpr RowKind kind = RowKind::inequality;
  std::array<BodyId, 2> bodies = {};
  Vec3 point_a = Vec3::Zero();    // m, in A's axes
  Vec3 point_b = Vec3::Zero();    // m, in B's axes
  Mat3 frame = Mat3::Identity();  // columns n, t_1, t_2, orthonormal, in B's axes
  double friction = 0;            // Coulomb's coefficient; 0: no tangent rows
  Vec3 surface = Vec3::Zero();    // m/s, in B's axes: how fast the face runs over B (a belt)

  template <class T>
  Vec<T, 1> value(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> apart = a * point_a - b * point_b;
    return Vec<T, 1>(b.turn(frame.col(0)).dot(apart));
  }

  Mat<double, 1, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    return row::separation(b.turn(frame.col(0)), a * point_a, a.position, b.position);
  }

  // How far A's point is from B's along the tangents, m.
  template <class T>
  Vec<T, 2> offset(const Pose<T>& a, const Pose<T>& b) const {
    const Vec<T, 3> apart = a * point_a - b * point_b;
    return {b.turn(frame.col(1)).dot(apart), b.turn(frame.col(2)).dot(apart)};
  }

  Slip<2> slip(const Pose<double>& a, const Pose<double>& b) const {
    Slip<2> out;
    for (int k = 0; k < 2; ++k) {
      out.jacobian.row(k) = row::separation(b.turn(frame.col(1 + k)), a * point_a, a.position, b.position);
      out.surface[k] = frame.col(1 + k).dot(surface);
    }
    return out;
  }
};
static_assert(Constraint<Contact> && HasJacobian<Contact> && HasSlip<Contact>);

// The same over a pad that gives way along the normal: gap + s >= 0, where s is the contact's force times the softness.
struct PadContact : Contact {
  static constexpr auto name = "pad_contact";
  double softness = 0;  // [m/s^2 per N]; 0: hard

  Vec<double, 1> compliance() const { return Vec<double, 1>(softness); }
};
static_assert(Constraint<PadContact> && HasCompliance<PadContact>);

// A right-handed orthonormal frame [n, t_1, t_2] over a unit normal: the x and y axes, turned by the shortest way from
// z to n (Frisvad, J. Graphics Tools 16, 2012), or from -z where n points down. No choice is continuous on the whole
// sphere; this one jumps on one circle only, away from floors, walls and ceilings.
inline Mat3 contact_frame(const Vec3& normal) {
  const double up = normal.z() > -0.35 ? 1 : -1;
  const double x = normal.x(), y = normal.y(), scale = 1 / (1 + up * normal.z());
  Mat3 frame;
  frame << x, 1 - x * x * scale, -x * y * scale * up,  //
      y, -x * y * scale, (1 - y * y * scale) * up,     //
      normal.z(), -x * up, -y;
  return frame;
}

// The contact of A at `point` [m, world] with the face of B that lies `gap` [m] below it along -normal [world, unit].
inline Contact contact_at(const std::vector<Body>& bodies, BodyId a, BodyId b, const Vec3& point, const Vec3& normal,
                          double gap = 0, double friction = 0) {
  const Pose<double>& on = bodies[at(a)].pose;
  const Pose<double>& by = bodies[at(b)].pose;
  return {.bodies = {a, b},
          .point_a = on.rotation.transpose() * (point - on.position),
          .point_b = by.rotation.transpose() * (point - gap * normal - by.position),
          .frame = by.rotation.transpose() * contact_frame(normal),
          .friction = friction};
}

}  // namespace zwang
