#include <zwang/collision/halves.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace zwang::collision {

Halves::Halves(const Mesh& mesh) {
  std::vector<Vec3> centre;  // times 3
  for (const auto& [a, b, c] : mesh.triangles) centre.push_back(mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]);
  std::vector<int> order = numbers_from(0, mesh.triangles.size());
  nodes_.reserve(2 * order.size());
  nodes_.push_back({});
  struct Open {
    std::size_t node;
    std::span<int> triangles;
  };
  for (std::vector<Open> open{{0, order}}; !open.empty();) {
    const auto [number, triangles] = open.back();
    open.pop_back();
    Eigen::AlignedBox3d box, centres;
    for (const int t : triangles) {
      for (const std::uint32_t v : mesh.triangles[at(t)]) box.extend(mesh.vertices[v]);
      centres.extend(centre[at(t)]);
    }
    const bool leaf = triangles.size() == 1;
    nodes_[number] = {{box.min(), box.max()},
                      static_cast<int>(triangles.size()),
                      leaf ? triangles[0] : static_cast<int>(nodes_.size())};
    if (leaf) continue;
    Index axis;
    centres.sizes().maxCoeff(&axis);
    const std::size_t half = triangles.size() / 2;
    std::nth_element(triangles.begin(), triangles.begin() + static_cast<long>(half), triangles.end(),
                     [&](int a, int b) {
                       const double of_a = centre[at(a)][axis], of_b = centre[at(b)][axis];
                       return of_a < of_b || (of_a == of_b && a < b);
                     });
    open.push_back({nodes_.size() + 1, triangles.subspan(half)});
    open.push_back({nodes_.size(), triangles.first(half)});
    nodes_.resize(nodes_.size() + 2);
  }
}

bool mostly_slivers(const Mesh& mesh) {
  std::size_t slivers = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
    const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
    slivers += longest > 20 * u.cross(v).norm();
  }
  return 4 * slivers >= mesh.triangles.size();
}

}  // namespace zwang::collision
