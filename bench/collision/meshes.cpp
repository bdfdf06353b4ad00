#include <zwang/bench/collision/meshes.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace zwang::meshes {
namespace {

using collision::Mesh;
using std::numbers::pi;

// The image of a grid of nu x nv cells of [0, 1]^2; cells of which `kept` says no are left out.
void add_grid(Mesh& mesh, int nu, int nv, const std::function<Vec3(double, double)>& point,
              const std::function<bool(int, int)>& kept = {}) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i)
      mesh.vertices.push_back(point(i / static_cast<double>(nu), j / static_cast<double>(nv)));
  const auto at = [&](int i, int j) { return first + static_cast<std::uint32_t>(j * (nu + 1) + i); };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      if (kept && !kept(i, j)) continue;
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

int side(std::size_t triangles, double faces, double ratio = 1) {
  return std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(triangles) / (2 * faces) * ratio))));
}

Mesh cleaned(Mesh mesh) {
  collision::clean(mesh, 1e-9);
  return mesh;
}

}  // namespace

Mesh box(const Vec3& widths) { return plate(widths, 4); }

Mesh plate(const Vec3& widths, std::size_t triangles) { return perforated(widths, 0, triangles); }

Mesh sheet(double width, double depth, std::size_t triangles) {
  Mesh mesh;
  const int nu = side(triangles, 1, width / depth), nv = side(triangles, 1, depth / width);
  add_grid(mesh, nu, nv, [&](double u, double v) { return Vec3((u - 0.5) * width, (v - 0.5) * depth, 0); });
  return cleaned(std::move(mesh));
}

Mesh perforated(const Vec3& w, int holes, std::size_t triangles) {
  Mesh mesh;
  const int nu = side(triangles, 2, w.x() / w.y()), nv = side(triangles, 2, w.y() / w.x());
  // Every hole takes the middle half of its share of the plate.
  const auto kept = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= nu || j >= nv) return false;
    const auto part = [&](int k, int n) {
      const double x = (k + 0.5) / n * holes;
      return x - std::floor(x);
    };
    return holes == 0 || std::abs(part(i, nu) - 0.5) > 0.25 || std::abs(part(j, nv) - 0.5) > 0.25;
  };
  for (const double z : {-0.5, 0.5})
    add_grid(
        mesh, nu, nv, [&](double u, double v) { return Vec3((u - 0.5) * w.x(), (v - 0.5) * w.y(), z * w.z()); }, kept);
  // Walls where a cell has no neighbour.
  const auto layer = static_cast<std::uint32_t>(mesh.vertices.size() / 2);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (nu + 1) + i); };
  const auto wall = [&](std::uint32_t p, std::uint32_t q) {
    mesh.triangles.push_back({p, q, q + layer});
    mesh.triangles.push_back({p, q + layer, p + layer});
  };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      if (!kept(i, j)) continue;
      if (!kept(i - 1, j)) wall(at(i, j), at(i, j + 1));
      if (!kept(i + 1, j)) wall(at(i + 1, j), at(i + 1, j + 1));
      if (!kept(i, j - 1)) wall(at(i, j), at(i + 1, j));
      if (!kept(i, j + 1)) wall(at(i, j + 1), at(i + 1, j + 1));
    }
  return cleaned(std::move(mesh));
}

Mesh pipe(double radius, double wall, double length, std::size_t triangles) {
  Mesh mesh;
  // Around, and along a loop up the outside and down the inside.
  const double loop = 2 * (length + wall), ratio = 2 * pi * radius / loop;
  const int nu = std::max(3, side(triangles, 1, ratio)), nv = std::max(4, side(triangles, 1, 1 / ratio));
  add_grid(mesh, nu, nv, [&](double u, double v) {
    double at = v * loop, r = radius, z = 0;
    if (at <= length) {
      z = at;
    } else if ((at -= length) <= wall) {
      z = length, r = radius - at;
    } else if ((at -= wall) <= length) {
      z = length - at, r = radius - wall;
    } else {
      r = radius - wall + (at - length);
    }
    const double angle = 2 * pi * (u == 1 ? 0 : u);
    return Vec3(r * std::cos(angle), r * std::sin(angle), z - length / 2);
  });
  return cleaned(std::move(mesh));
}

Mesh gear(double radius, double thickness, int teeth, std::size_t triangles) {
  Mesh mesh;
  const double hole = 0.3 * radius;
  const auto rim = [&](double angle) {
    return radius * (1 - 0.12 * std::clamp(1.5 * std::sin(teeth * angle), -1.0, 1.0));
  };
  // Around, and along a loop: up the rim, over the top, down the hole, back below.
  const double loop = 2 * (thickness + radius - hole), ratio = 2 * pi * radius / loop;
  const int nu = std::max(8 * teeth, side(triangles, 1, ratio));
  const int nv = std::max(4, static_cast<int>(triangles) / (2 * nu));
  add_grid(mesh, nu, nv, [&](double u, double v) {
    const double angle = 2 * pi * (u == 1 ? 0 : u), outer = rim(angle);
    double at = (v == 1 ? 0 : v) * loop, r = outer, z = 0;
    if (at <= thickness) {
      z = at;
    } else if ((at -= thickness) <= radius - hole) {
      z = thickness, r = outer + (hole - outer) * at / (radius - hole);
    } else if ((at -= radius - hole) <= thickness) {
      z = thickness - at, r = hole;
    } else {
      r = hole + (outer - hole) * (at - thickness) / (radius - hole);
    }
    return Vec3(r * std::cos(angle), r * std::sin(angle), z - thickness / 2);
  });
  return cleaned(std::move(mesh));
}

Mesh bumpy_sphere(double radius, double bump, int waves, std::size_t triangles) {
  Mesh mesh;
  const int nu = std::max(4, side(triangles, 1, 2)), nv = std::max(3, side(triangles, 1, 0.5));
  add_grid(mesh, nu, nv, [&](double u, double v) {
    const double a = 2 * pi * (u == 1 ? 0 : u), b = pi * v, around = v == 0 || v == 1 ? 0 : std::sin(b);
    const double r = radius + bump * std::sin(waves * a) * std::sin(waves * b) * around;
    return Vec3(r * around * std::cos(a), r * around * std::sin(a), r * std::cos(b));
  });
  return cleaned(std::move(mesh));
}

Mesh slivers(double radius, double thickness, std::size_t triangles) {
  Mesh mesh;
  const int n = static_cast<int>(triangles / 2);
  for (const double z : {0.0, -thickness}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0, 0, z);
    for (int k = 0; k < n; ++k)
      mesh.vertices.emplace_back(radius * std::cos(2 * pi * k / n), radius * std::sin(2 * pi * k / n), z);
    for (int k = 0; k < n; ++k)
      mesh.triangles.push_back(
          {first, first + 1 + static_cast<std::uint32_t>(k), first + 1 + static_cast<std::uint32_t>((k + 1) % n)});
  }
  return cleaned(std::move(mesh));
}

}  // namespace zwang::meshes
