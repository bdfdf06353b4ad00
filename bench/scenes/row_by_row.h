#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/constraints/contact.h>
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

// A problem written down row by row, as a paper prints it, with a diagonal M.
class RowByRow {
 public:
  RowByRow(const Vector& mass, const Vector& z_u, double mu = 0) : mu_(mu) {
    instance_.problem.M = mass.asDiagonal();
    instance_.problem.z_u = z_u;
  }

  // Rows are keyed 1, 2, 3, ... unless `key` says otherwise.
  void add(RowKind kind, const Vector& row, double c, const std::string& origin, std::uint64_t key = 0) {
    rows_.add(kind, {key > 0 ? key : static_cast<std::uint64_t>(rows_.rows()) + 1, 0}, c);
    rows_.entries(row);
    RowOrigin& written = instance_.origin.emplace_back(parse_row_origin(origin));
    if (written.type == "contact" || written.type == "ball_joint") written.unit = "m/s^2";
  }

  void add_contact(const Vector& row, double c, const std::string& label, std::uint64_t key = 0) {
    add(RowKind::inequality, row, c, "contact/" + label, key);
  }
  // With friction, the last contact slips along two tangents of its normal, as long as that: row_of(t) is the row of a
  // tangent.
  template <class RowOf>
  void add_slip(const Vec3& normal, const RowOf& row_of) {
    if (mu_ == 0) return;
    const double length = normal.norm();
    const Mat3 frame = contact_frame(normal / length);
    for (int k = 1; k <= 2; ++k) {
      const Vector row = row_of(Vec3(length * frame.col(k)));
      SlipRow& slip = slips_.emplace_back(SlipRow{.contact = rows_.rows() - 1});
      for (Index j = 0; j < row.size(); ++j)
        if (row[j] != 0) slip.entries.emplace_back(static_cast<int>(j), row[j]);
    }
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
    return slips_.empty() ? std::move(instance_) : with_friction(instance_, mu_, slips_);
  }
  Instance finish(Reference reference) {
    instance_.reference = std::move(reference);
    return finish();
  }

 private:
  Instance instance_ = {};
  RowWriter rows_ = {};
  double mu_;
  std::vector<SlipRow> slips_ = {};
};

}  // namespace zwang
