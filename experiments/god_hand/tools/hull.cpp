#include <zwang/experiments/god_hand/tools/hull.h>

#include <algorithm>
#include <cmath>

namespace zwang::god {

std::vector<Vec3> directions() {
  std::vector<Vec3> out;
  for (int k = 0; k < 64; ++k) {
    const double z = 1 - (2 * k + 1) / 64., turn = 2.399963229728653 * k, r = std::sqrt(1 - z * z);
    out.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return out;
}

Hull hull_of(std::span<const Vec3> vertices) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : vertices) box.extend(v);
  const Vec3 middle = box.center();
  std::vector<Vec3> points;
  for (const Vec3& way : directions()) {
    Vec3 best = middle;
    double most = -1;
    for (const Vec3& vertex : vertices)
      if (const double far = way.dot(vertex - middle); far > most) most = far, best = vertex;
    const Vec3 point = best - middle;
    if (std::ranges::none_of(points, [&](const Vec3& p) { return p == point; })) points.push_back(point);
  }
  return {collision::Shape::hull(points, 5e-4), middle, box.sizes().cwiseMax(1e-3)};
}

Hull hull_of(const collision::Tree& mesh) {
  std::vector<Vec3> vertices;
  for (const collision::Triangle& triangle : mesh.triangles())
    for (const Vec3& corner : triangle.corner) vertices.push_back(corner);
  return hull_of(vertices);
}

}  // namespace zwang::god
