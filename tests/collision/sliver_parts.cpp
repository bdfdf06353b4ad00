#include "tests/collision/sliver_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace zwang::meshes {
namespace {

using collision::Mesh;
using std::numbers::pi;
using Vec2 = Eigen::Vector2d;
using Outline = std::vector<Vec2>;

Vec2 polar(double radius, double angle) { return {radius * std::cos(angle), radius * std::sin(angle)}; }

// A polygon, closed or not, whose corners are arcs that begin and end `fillet` before and behind them. A corner and the
// side behind it get `points` points, three quarters of them on the arc.
Outline rounded(const Outline& corners, double fillet, int points, bool closed = true) {
  const int arc = std::max(2, 3 * points / 4), side = std::max(1, points - arc);
  const std::size_t n = corners.size();
  const auto toward = [&](const Vec2& from, const Vec2& to) { return Vec2(from + fillet * (to - from).normalized()); };
  Outline outline;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 &here = corners[k], &before = corners[(k + n - 1) % n], &next = corners[(k + 1) % n];
    const bool first = !closed && k == 0, last = !closed && k + 1 == n;
    if (last) {
      outline.push_back(here);
      break;
    }
    const Vec2 from = toward(here, before), to = first ? here : toward(here, next);
    for (int i = 0; i < arc && !first; ++i) {
      const double t = i / static_cast<double>(arc);
      outline.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * here + t * t * to);
    }
    const Vec2 end = !closed && k + 2 == n ? next : toward(next, here);
    for (int i = 0; i < side; ++i) outline.push_back(to + i / static_cast<double>(side) * (end - to));
  }
  return outline;
}

// Triangles between two lists of vertices of the same length.
void add_strip(Mesh& mesh, const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b, bool closed) {
  for (std::size_t k = 0; k + (closed ? 0 : 1) < a.size(); ++k) {
    const std::size_t next = (k + 1) % a.size();
    mesh.triangles.push_back({a[k], a[next], b[next]});
    mesh.triangles.push_back({a[k], b[next], b[k]});
  }
}

std::vector<std::uint32_t> add_ring(Mesh& mesh, const Outline& outline, double z) {
  std::vector<std::uint32_t> ring;
  for (const Vec2& p : outline) {
    ring.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.emplace_back(p.x(), p.y(), z);
  }
  return ring;
}

void add_fan(Mesh& mesh, const std::vector<std::uint32_t>& ring, const Vec3& middle, bool up) {
  const auto center = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(middle);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const std::uint32_t a = ring[k], b = ring[(k + 1) % ring.size()];
    mesh.triangles.push_back(up ? std::array{center, a, b} : std::array{center, b, a});
  }
}

Mesh cleaned(Mesh mesh) {
  collision::clean(mesh);
  return mesh;
}

}  // namespace

Mesh sliver_gear(double radius, double thickness, int teeth, int points, int layers, double fillet) {
  const double root = 0.92 * radius, bore = 0.37 * radius, step = 2 * pi / teeth;
  Outline corners;
  for (int k = 0; k < teeth; ++k)
    for (const auto& [r, at] : {std::pair(root, 0.1), {radius, 0.35}, {radius, 0.65}, {root, 0.9}})
      corners.push_back(polar(r, (k + at) * step));
  const Outline rim = rounded(corners, fillet, points / 4);
  Outline hole;
  for (const Vec2& p : rim) hole.push_back(bore * p.normalized());

  Mesh mesh;
  std::vector<std::vector<std::uint32_t>> outer, inner;
  for (int k = 0; k <= layers; ++k) {
    const double z = thickness * k / layers;
    outer.push_back(add_ring(mesh, rim, z));
    inner.push_back(add_ring(mesh, hole, z));
    if (k == 0) continue;
    const auto now = static_cast<std::size_t>(k);
    add_strip(mesh, outer[now - 1], outer[now], true);
    add_strip(mesh, inner[now], inner[now - 1], true);
  }
  add_strip(mesh, inner.front(), outer.front(), true);
  add_strip(mesh, outer.back(), inner.back(), true);
  return cleaned(std::move(mesh));
}

Mesh sliver_thread(double radius, double pitch, int turns, int steps, int points, double fillet) {
  const double depth = 0.6 * pitch, root = radius - depth;
  // Along the axis and outward, over one pitch.
  const Outline profile = rounded({{0, root},
                                   {0.1 * pitch, root},
                                   {0.4 * pitch, radius},
                                   {0.6 * pitch, radius},
                                   {0.9 * pitch, root},
                                   {pitch, root}},
                                  fillet, points / 4, false);
  Mesh mesh;
  std::vector<std::vector<std::uint32_t>> lines;
  for (int k = 0; k <= turns * steps; ++k) {
    auto& line = lines.emplace_back();
    const double angle = 2 * pi * (k % steps) / steps, rise = pitch * k / steps;
    for (const Vec2& p : profile) {
      line.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      const Vec2 out = polar(p.y(), angle);
      mesh.vertices.emplace_back(out.x(), out.y(), p.x() + rise);
    }
    if (k > 0) add_strip(mesh, lines[lines.size() - 2], line, false);
  }
  // The first turn's lower side and its profile, and the last turn's upper side and its profile.
  std::vector<std::uint32_t> low, high;
  for (int k = 0; k < steps; ++k) {
    low.push_back(lines[static_cast<std::size_t>(k)].front());
    high.push_back(lines[lines.size() - 1 - static_cast<std::size_t>(k)].back());
  }
  for (std::size_t k = profile.size() - 1; k > 0; --k) {
    low.push_back(lines.front()[k]);
    high.push_back(lines.back()[profile.size() - 1 - k]);
  }
  add_fan(mesh, low, {0, 0, 0}, false);
  add_fan(mesh, high, {0, 0, pitch * (turns + 1)}, false);
  return cleaned(std::move(mesh));
}

Mesh sliver_plate(const Vec3& widths, int strips) {
  Mesh mesh;
  const auto edge = [&](double x, double z) {
    Outline outline;
    for (int i = 0; i <= strips; ++i) outline.emplace_back(x, widths.y() * (i / static_cast<double>(strips) - 0.5));
    return add_ring(mesh, outline, z);
  };
  const double x = widths.x() / 2, z = widths.z();
  const std::array edges{edge(-x, 0), edge(x, 0), edge(x, z), edge(-x, z)};
  for (std::size_t k = 0; k < 4; ++k) add_strip(mesh, edges[(k + 1) % 4], edges[k], false);
  for (const bool last : {false, true}) {
    const auto corner = [&](std::size_t k) { return last ? edges[k].back() : edges[k].front(); };
    mesh.triangles.push_back({corner(0), corner(last ? 2 : 1), corner(last ? 1 : 2)});
    mesh.triangles.push_back({corner(0), corner(last ? 3 : 2), corner(last ? 2 : 3)});
  }
  return mesh;
}

Mesh sliver_loft(double radius, double height, int points, double fillet) {
  Outline square;
  for (int k = 0; k < 4; ++k) square.push_back(polar(radius, k * pi / 2));
  const Outline base = rounded(square, fillet, points / 4);
  const std::size_t of_corner = base.size() / 4;
  Outline turned;
  for (int k = 0; k < 4; ++k) turned.push_back(polar(0.8 * radius, (k + 0.5) * pi / 2));
  Mesh mesh;
  const std::vector<std::uint32_t> low = add_ring(mesh, base, 0), high = add_ring(mesh, turned, height);
  for (std::size_t k = 0; k < base.size(); ++k)
    mesh.triangles.push_back({low[k], low[(k + 1) % low.size()], high[k / of_corner]});
  for (std::size_t c = 0; c < 4; ++c) mesh.triangles.push_back({low[c * of_corner], high[c], high[(c + 3) % 4]});
  add_fan(mesh, low, {0, 0, 0}, false);
  add_fan(mesh, high, {0, 0, height}, true);
  return cleaned(std::move(mesh));
}

Mesh spoiled(const Mesh& mesh) {
  Mesh out = mesh;
  const Vec3 off = Vec3::Constant(1e-10);
  const auto add = [&](const Vec3& p) {
    out.vertices.push_back(p);
    return static_cast<std::uint32_t>(out.vertices.size() - 1);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    if (t % 7 == 0) out.triangles.push_back({add(p + off), add(q + off), add(r + off)});
    if (t % 11 == 0) {  // a point on one edge that the neighbour does not have
      const std::uint32_t middle = add(0.4 * p + 0.6 * q);
      out.triangles[t] = {a, middle, c};
      out.triangles.push_back({middle, b, c});
    }
    if (t % 13 == 0) out.triangles.push_back({b, c, add((q + r) / 2 + 1e-12 * (p - q))});
  }
  Vec3 low = mesh.vertices[0];
  for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p);
  out.triangles.push_back({add({-1, -1, low.z() - 1e-4}), add({1, -1, low.z() - 1e-4}), add({0, 1.5, low.z() - 1e-4})});
  return cleaned(std::move(out));
}

Aspects aspects(const Mesh& mesh) {
  std::vector<double> all;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
    all.push_back(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}) / u.cross(v).norm());
  }
  std::sort(all.begin(), all.end());
  return {all[all.size() / 2], all.back()};
}

}  // namespace zwang::meshes
