#include <zwang/bench/collision/hull_faces.h>

#include <algorithm>

namespace zwang {

std::vector<HullFace> hull_faces(std::span<const Vec3> corners) {
  std::vector<HullFace> faces;
  double size = 0;
  for (const Vec3& p : corners) size = std::max(size, (p - corners[0]).norm());
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const Vec3 n = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
        if (n.norm() <= 1e-10 * size * size) continue;
        for (const Vec3& normal : {Vec3(n.normalized()), Vec3(-n.normalized())}) {
          const double offset = normal.dot(corners[i]);
          const auto below = [&](const Vec3& p) { return normal.dot(p) <= offset + 1e-9 * size; };
          if (std::ranges::all_of(corners, below)) faces.push_back({normal, offset, {i, j, k}});
        }
      }
  return faces;
}

}  // namespace zwang
