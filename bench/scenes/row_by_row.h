#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/constraints/contact.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {

// Adds sign * direction . (v + w x point), the row of a point that moves with a body, in [linear; angular] columns.
inline void add_point(Vector& row, Index body, double sign, const Vec3& point, const Vec3& direction) {
  row.segment<3>(6 * body) += sign * direction;
  row.segment<3>(6 * body + 3) += sign * point.cross(direction);
}

// The row of the difference of two points' velocities along a direction: of `body` at `point` and of the body before it
// at `point_before`; of body 0 alone.
inline Vector point_row(Index unknowns, Index body, const Vec3& point, const Vec3& point_before,
                        const Vec3& direction) {
  Vector row = Vector::Zero(unknowns);
  add_point(row, body, 1, point, direction);
  if (body > 0) add_point(row, body - 1, -1, point_before, direction);
  return row;
}

// A corner of the lower face of a unit box.
inline Vec3 box_corner(Index corner) { return {corner % 2 ? .5 : -.5, corner / 2 ? .5 : -.5, -.5}; }

// A problem written down row by row, as a paper prints it, with a diagonal M. mu: of the contacts that slip.
class RowByRow {
 public:
  RowByRow(const Vector& mass, const Vector& z_u, double mu = 0) : mu_(mu) {
    instance_.problem.M = mass.asDiagonal();
    instance_.problem.z_u = z_u;
  }

  // Constraints are keyed 1, 2, 3, ... unless `key` says otherwise.
  void add(RowKind kind, const Vector& row, double c, const std::string& origin, std::uint64_t key = 0) {
    ++constraints_;
    key_ = {key > 0 ? key : constraints_, 0};
    rows_.add(kind, key_, c, kind == RowKind::inequality ? mu_ : 0);
    rows_.entries(row);
    RowOrigin& written = instance_.origin.emplace_back(parse_row_origin(origin));
    if (written.type == "contact" || written.type == "ball_joint") written.unit = "m/s^2";
  }

  void add_contact(const Vector& row, double c, const std::string& label, std::uint64_t key = 0) {
    add(RowKind::inequality, row, c, "contact/" + label, key);
  }
  // Of a point of the body with one of the body before it, body 0 with the ground. It slips along two tangents of its
  // normal, as long as that, where there is friction.
  void add_contact(const Vec3& normal, Index body, const Vec3& point, const Vec3& point_before, double c,
                   const std::string& label, std::uint64_t key = 0) {
    const auto row_of = [&, n = instance_.problem.z_u.size()](const Vec3& way) {
      return point_row(n, body, point, point_before, way);
    };
    add_contact(row_of(normal), c, label, key);
    if (mu_ == 0) return;
    const double length = normal.norm();
    const Mat3 frame = contact_frame(normal / length);
    for (int k = 1; k <= 2; ++k) {
      add_tangent(row_of(Vec3(length * frame.col(k))), 0);
      instance_.origin.back().row = k;
    }
  }
  // A contact with friction of its own: rows of the normal and its tangents, c beside them.
  void add_contact(const std::vector<Vector>& rows, const std::vector<double>& c, double mu, const std::string& label) {
    mu_ = mu;
    add_contact(rows[0], c[0], label);
    for (std::size_t t = 1; t < rows.size(); ++t) add_tangent(rows[t], c[t]);
    for (std::size_t t = 0; t < rows.size() && rows.size() > 1; ++t)
      instance_.origin[instance_.origin.size() - rows.size() + t].row = static_cast<int>(t);
  }
  void add_equality(const Vector& row, double c, const std::string& origin) { add(RowKind::equality, row, c, origin); }
  // Ties the body to the one before it, body 0 to the ground.
  void add_ball_joint(Index body, const Vec3& point, const Vec3& point_before) {
    for (Index axis = 0; axis < 3; ++axis)
      add_equality(point_row(instance_.problem.z_u.size(), body, point, point_before, Vec3::Unit(axis)), 0,
                   "ball_joint/" + std::to_string(body) + " [" + std::to_string(axis) + "]");
  }

  Instance finish() {
    Problem& p = instance_.problem;
    rows_.write(p);
    if (!p.has_tangents()) return std::move(instance_);
    p.law = stored_law;
    if (instance_.reference) instance_.reference = known_with_friction(*std::move(instance_.reference), p);
    return std::move(instance_);
  }
  // Of the rows that are no tangents.
  Instance finish(Reference reference) {
    instance_.reference = std::move(reference);
    return finish();
  }

 private:
  void add_tangent(const Vector& row, double c) {
    ++key_.row;
    rows_.add(RowKind::tangent, key_, c);
    rows_.entries(row);
    instance_.origin.push_back(instance_.origin.back());
  }

  Instance instance_ = {};
  RowWriter rows_ = {};
  double mu_;
  std::uint64_t constraints_ = 0;
  RowKey key_ = {};  // of the last row
};

// Unit boxes one on another, I = m/8, that fall and are pushed along x by `push` weights.
inline RowByRow box_stack(const std::vector<double>& masses, double mu, double push = 0) {
  const auto n = static_cast<Index>(6 * masses.size());
  Vector mass(n), z_u = Vector::Zero(n);
  for (Index b = 0; 6 * b < n; ++b) {
    mass.segment<3>(6 * b).setConstant(masses[at(b)]);
    mass.segment<3>(6 * b + 3).setConstant(masses[at(b)] / 8);
    z_u[6 * b + 2] = -g_dyadic;
    z_u[6 * b] = push * g_dyadic;
  }
  return {mass, z_u, mu};
}

}  // namespace zwang
