#include <zwang/collision/mesh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/problem/wording.h>

namespace zwang::collision {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// An open-addressing table from hash to vertex: one array, no node per vertex (a million vertices in 0.1 s).
class VertexTable {
 public:
  explicit VertexTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), none) {}

  // The vertex among those of this hash that `same` accepts, or none, and then the place for a new one.
  template <class Same>
  std::uint32_t& find(std::uint64_t hash, Same same) {
    for (std::size_t at = hash & (slots_.size() - 1);; at = (at + 1) & (slots_.size() - 1))
      if (slots_[at] == none || same(slots_[at])) return slots_[at];
  }

 private:
  std::vector<std::uint32_t> slots_;
};

using Cell = std::array<std::int64_t, 3>;

std::uint64_t hash_of(const Cell& c) {
  std::uint64_t h = 0;
  for (const std::int64_t k : c) h = mix_bits(h + 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(k));
  return h;
}

// With width 0 a cell is the vertex itself (-0 counts as 0).
Cell cell_of(const Vec3& p, double width) {
  Cell c;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[static_cast<Index>(k)];
    c[k] = width > 0 ? static_cast<std::int64_t>(std::floor(std::clamp(x / width, -9e18, 9e18)))
                     : std::bit_cast<std::int64_t>(x + 0.0);
  }
  return c;
}

// Which earlier vertex each one is merged into. Cells are four times as wide as the weld distance: most vertices are
// farther than that from their cell's sides, and ask no other one.
std::vector<std::uint32_t> welded(const std::vector<Vec3>& vertices, double weld) {
  const double width = 4 * weld;
  const Vec3 reach = Vec3::Constant(weld);
  VertexTable table(vertices.size());
  std::vector<std::uint32_t> first(vertices.size());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    const Vec3& p = vertices[v];
    const auto near = [&](std::uint32_t u) { return (vertices[u] - p).cwiseAbs().maxCoeff() <= weld; };
    const Cell home = cell_of(p, width), low = cell_of(p - reach, width), high = cell_of(p + reach, width);
    std::uint32_t& at_home = table.find(hash_of(home), near);
    std::uint32_t found = at_home;
    if (weld > 0)
      for (Cell c = low; c[0] <= high[0] && found == none; ++c[0])
        for (c[1] = low[1]; c[1] <= high[1] && found == none; ++c[1])
          for (c[2] = low[2]; c[2] <= high[2] && found == none; ++c[2])
            if (c != home) found = table.find(hash_of(c), near);
    first[v] = found == none ? at_home = v : found;
  }
  return first;
}

void require_sound(const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw std::invalid_argument("vertex " + std::to_string(v) + " is not a finite point");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        throw std::invalid_argument("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                                    ", there are " + std::to_string(mesh.vertices.size()));
}

// No area that double precision could tell from rounding.
bool degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() <= 1e-14 * longest;
}

void drop_repeated(Mesh& mesh, MeshReport& report) {
  VertexTable table(mesh.triangles.size());
  std::vector<std::array<std::uint32_t, 3>> kept;
  kept.reserve(mesh.triangles.size());
  const auto sorted = [](std::array<std::uint32_t, 3> t) {
    std::sort(t.begin(), t.end());
    return t;
  };
  for (const auto& triangle : mesh.triangles) {
    const auto corners = sorted(triangle);
    const std::uint64_t hash = hash_of({corners[0], corners[1], corners[2]});
    std::uint32_t& found = table.find(hash, [&](std::uint32_t t) { return sorted(kept[t]) == corners; });
    if (found != none) continue;
    found = static_cast<std::uint32_t>(kept.size());
    kept.push_back(triangle);
  }
  report.repeated = mesh.triangles.size() - kept.size();
  mesh.triangles = std::move(kept);
}

void forget_unused(Mesh& mesh) {
  std::vector<std::uint32_t> place(mesh.vertices.size(), none);
  std::vector<Vec3> used;
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) {
      if (place[v] == none) {
        place[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.vertices[v]);
      }
      v = place[v];
    }
  mesh.vertices = std::move(used);
}

void count_edges(const Mesh& mesh, MeshReport& report) {
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back(std::uint64_t{low} << 32 | high);
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    report.boundary_edges += j - i == 1;
    report.non_manifold_edges += j - i > 2;
  }
}

}  // namespace

std::string to_string(const MeshReport& r) {
  const Vec3 size = 1000 * (r.high - r.low);
  const auto some = [](std::size_t n, const char* what) { return grouped(n) + " " + what; };
  return counted(r.triangles_read - r.degenerate - r.repeated, "triangle") +
         printed(", %.4g x %.4g x %.4g mm; ", size.x(), size.y(), size.z()) + some(r.welded, "vertices welded; ") +
         some(r.degenerate, "degenerate and ") + some(r.repeated, "repeated triangles dropped; ") +
         some(r.boundary_edges, "boundary and ") + some(r.non_manifold_edges, "non-manifold edges");
}

MeshReport clean(Mesh& mesh, double weld) {
  require_sound(mesh);
  MeshReport report;
  report.triangles_read = mesh.triangles.size();

  const std::vector<std::uint32_t> first = welded(mesh.vertices, weld);
  for (std::uint32_t v = 0; v < first.size(); ++v) report.welded += first[v] != v;
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) v = first[v];

  report.degenerate = std::erase_if(mesh.triangles, [&](const auto& t) { return degenerate(mesh, t); });
  drop_repeated(mesh, report);
  if (mesh.triangles.empty()) throw std::invalid_argument("no triangle with an area");
  forget_unused(mesh);
  count_edges(mesh, report);

  report.low = report.high = mesh.vertices[0];
  for (const Vec3& p : mesh.vertices) {
    report.low = report.low.cwiseMin(p);
    report.high = report.high.cwiseMax(p);
  }
  return report;
}

}  // namespace zwang::collision
