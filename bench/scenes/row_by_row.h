#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// Adds sign * direction . (v + w x point), the row of a point that moves with a body, in [linear; angular] columns.
inline void add_point(Vector& row, Index body, double sign, const Vec3& point, const Vec3& direction) {
  row.segment<3>(6 * body) += sign * direction;
  row.segment<3>(6 * body + 3) += sign * point.cross(direction);
}

// A problem written down row by row, as a paper prints it, with a diagonal M.
class RowByRow {
 public:
  RowByRow(const Vector& mass, const Vector& z_u) {
    const Index n = mass.size();
    instance_.problem.M.resize(n, n);
    for (Index j = 0; j < n; ++j) instance_.problem.M.insert(j, j) = mass[j];
    instance_.problem.z_u = z_u;
  }

  // Rows are keyed 1, 2, 3, ... unless `key` says otherwise.
  void add(RowKind kind, const Vector& row, double c, const std::string& origin, std::uint64_t key = 0) {
    const int i = static_cast<int>(c_.size());
    for (Index j = 0; j < row.size(); ++j)
      if (row[j] != 0) entries_.emplace_back(i, static_cast<int>(j), row[j]);
    c_.push_back(c);
    instance_.problem.kind.push_back(kind);
    instance_.problem.key.push_back({key > 0 ? key : static_cast<std::uint64_t>(i) + 1, 0});
    RowOrigin& written = instance_.origin.emplace_back(parse_row_origin(origin));
    if (written.type == "contact" || written.type == "ball_joint") written.unit = "m/s^2";
  }

  Instance finish() {
    Problem& p = instance_.problem;
    p.c = Eigen::Map<const Vector>(c_.data(), static_cast<Index>(c_.size()));
    p.J.resize(p.c.size(), p.z_u.size());
    p.J.setFromTriplets(entries_.begin(), entries_.end());
    p.M.makeCompressed();
    return std::move(instance_);
  }
  Instance finish(Reference reference) {
    instance_.reference = std::move(reference);
    return finish();
  }

 private:
  Instance instance_ = {};
  std::vector<Eigen::Triplet<double>> entries_ = {};
  std::vector<double> c_ = {};
};

}  // namespace zwang
