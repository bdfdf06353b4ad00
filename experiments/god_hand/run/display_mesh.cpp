#include <zwang/experiments/god_hand/run/display_mesh.h>

#include <meshoptimizer.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace zwang::god {
namespace {

using Point = Eigen::Vector3f;
static_assert(sizeof(Point) == 3 * sizeof(float));

// A vertex for each corner of triangles, welded where they are the same.
template <class Vertex>
struct Indexed {
  std::vector<Vertex> vertices;
  std::vector<unsigned> index;

  explicit Indexed(const std::vector<Vertex>& corners) : index(corners.size()) {
    vertices.resize(meshopt_generateVertexRemap(index.data(), nullptr, corners.size(), corners.data(), corners.size(),
                                                sizeof(Vertex)));
    meshopt_remapVertexBuffer(vertices.data(), corners.data(), corners.size(), sizeof(Vertex), index.data());
  }
};

// Twice the area times the unit normal.
Point area_normal(const Indexed<Point>& mesh, const unsigned* corner) {
  const Point a = mesh.vertices[corner[0]];
  return (mesh.vertices[corner[1]] - a).cross(mesh.vertices[corner[2]] - a);
}

// The normals of the full mesh's triangles around each vertex.
struct Fans {
  std::vector<unsigned> start, triangle;
  std::vector<Point> normal;

  explicit Fans(const Indexed<Point>& mesh) : start(mesh.vertices.size() + 1, 0), triangle(mesh.index.size()) {
    for (const unsigned v : mesh.index) ++start[v + 1];
    for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    std::vector<unsigned> at(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < mesh.index.size(); ++i) triangle[at[mesh.index[i]]++] = static_cast<unsigned>(i / 3);
    for (std::size_t i = 0; i < mesh.index.size(); i += 3) normal.push_back(area_normal(mesh, &mesh.index[i]));
  }

  // Of a corner of a shown triangle: the mean over the fan's triangles that face the same way to within 40 degrees.
  // Smooth surfaces look smooth and edges stay sharp. The mean over the whole fan makes boxes look rounded; the normals
  // of the simplified triangles alone give black spots.
  Point at(unsigned vertex, const Point& facing) const {
    constexpr float same_side = 0.766f;
    Point sum = Point::Zero(), all = sum;
    for (unsigned k = start[vertex]; k < start[vertex + 1]; ++k) {
      const Point& n = normal[triangle[k]];
      all += n;
      if (n.dot(facing) > same_side * n.norm()) sum += n;
    }
    if (sum.squaredNorm() > 0) return sum.normalized();
    return all.squaredNorm() > 0 ? all.normalized() : facing;  // a sliver that stands across
  }
};

// Unit vector -> the octahedron, unfolded to a square: two numbers in -32767 .. 32767.
std::array<std::int16_t, 2> octahedral(const Point& n) {
  const float sum = n.lpNorm<1>();
  Eigen::Vector2f p = n.head<2>() / (sum > 0 ? sum : 1);
  if (n.z() < 0)
    p = {(1 - std::abs(p.y())) * (p.x() < 0 ? -1.f : 1.f), (1 - std::abs(p.x())) * (p.y() < 0 ? -1.f : 1.f)};
  return {static_cast<std::int16_t>(std::lround(32767 * p.x())), static_cast<std::int16_t>(std::lround(32767 * p.y()))};
}

struct Vertex {
  std::array<std::uint16_t, 3> position;
  std::array<std::int16_t, 2> normal;
  std::uint16_t nothing;
};
static_assert(sizeof(Vertex) == 12);

}  // namespace

DisplayMesh display_mesh(const collision::Tree& tree, std::size_t triangles) {
  DisplayMesh out;
  out.full = tree.size();
  out.low = tree.box().min();
  out.size = std::max(tree.box().sizes().maxCoeff(), 1e-9);
  const Vec3 centre = tree.box().center();
  std::vector<Point> points;
  points.reserve(3 * tree.size());
  for (const collision::Triangle& triangle : tree.triangles())
    for (const Vec3& corner : triangle.corner) points.emplace_back((corner - centre).cast<float>());
  const Indexed<Point> mesh(points);

  std::vector<unsigned> shown = mesh.index;
  if (3 * triangles < shown.size()) {
    float error = 0;
    const float* from = mesh.vertices[0].data();
    shown.resize(meshopt_simplify(shown.data(), mesh.index.data(), mesh.index.size(), from, mesh.vertices.size(),
                                  sizeof(Point), 3 * triangles, 1.f, 0, &error));
    // Loose triangles (a soup, many small shells) cannot be collapsed while the topology is kept.
    if (shown.size() > 6 * triangles) {
      shown = mesh.index;
      shown.resize(meshopt_simplifySloppy(shown.data(), mesh.index.data(), mesh.index.size(), from,
                                          mesh.vertices.size(), sizeof(Point), 3 * triangles, 1.f, &error));
    }
    out.error = error * meshopt_simplifyScale(from, mesh.vertices.size(), sizeof(Point));
  }

  // One vertex for each corner, welded where position and normal are the same.
  const Fans fans(mesh);
  const Point low = (tree.box().min() - centre).cast<float>();
  std::vector<Vertex> corners;
  for (std::size_t i = 0; i < shown.size(); i += 3) {
    const Point facing = area_normal(mesh, &shown[i]).normalized();
    for (std::size_t k = i; k < i + 3; ++k) {
      const Point steps = (mesh.vertices[shown[k]] - low) * (65535 / static_cast<float>(out.size));
      Vertex v{{}, octahedral(fans.at(shown[k], facing)), 0};
      for (int axis = 0; axis < 3; ++axis)
        v.position[at(axis)] = static_cast<std::uint16_t>(std::clamp(std::lround(steps[axis]), 0l, 65535l));
      corners.push_back(v);
    }
  }
  auto [vertices, index] = Indexed<Vertex>(corners);
  out.vertices = vertices.size();
  out.indices = index.size();
  meshopt_optimizeVertexCache(index.data(), index.data(), index.size(), vertices.size());
  meshopt_optimizeVertexFetch(vertices.data(), index.data(), index.size(), vertices.data(), vertices.size(),
                              sizeof(Vertex));

  meshopt_encodeVertexVersion(0);
  meshopt_encodeIndexVersion(1);
  std::string& vb = out.vertex_bytes;
  std::string& ib = out.index_bytes;
  vb.resize(meshopt_encodeVertexBufferBound(vertices.size(), sizeof(Vertex)));
  vb.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vb.data()), vb.size(), vertices.data(),
                                       vertices.size(), sizeof(Vertex)));
  ib.resize(meshopt_encodeIndexBufferBound(index.size(), vertices.size()));
  ib.resize(
      meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(ib.data()), ib.size(), index.data(), index.size()));
  return out;
}

}  // namespace zwang::god
