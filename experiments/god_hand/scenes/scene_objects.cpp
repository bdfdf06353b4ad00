#include <zwang/experiments/god_hand/scenes/scene_objects.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <zwang/bench/collision/meshes.h>
#include <zwang/collision/world.h>

namespace zwang::god {
namespace {

using collision::Mesh;
using collision::Shape;
using std::numbers::pi;

constexpr double rounding = 0.002;  // m, of boxes and cylinders

Mat3 cyclic(int shift) {
  Mat3 R = Mat3::Zero();
  for (int k = 0; k < 3; ++k) R((k + shift) % 3, k) = 1;
  return R;
}

void append(Mesh& to, const Mesh& mesh, const Pose<double>& at) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  for (const Vec3& v : mesh.vertices) to.vertices.push_back(at * v);
  for (const auto& t : mesh.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace

TreePointer tree_of(const Mesh& mesh) { return std::make_shared<const collision::Tree>(mesh); }

Mat3 z_to_x() { return cyclic(1); }
Mat3 z_to_y() { return cyclic(2); }

Mesh cylinder_mesh(double radius, double height, int sides) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(sides);
  for (const double z : {-height / 2, height / 2}) {
    for (int k = 0; k < sides; ++k)
      mesh.vertices.emplace_back(radius * std::cos(2 * pi * k / sides), radius * std::sin(2 * pi * k / sides), z);
    mesh.vertices.emplace_back(0, 0, z);
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n, up = n + 1;
    mesh.triangles.insert(mesh.triangles.end(),
                          {{k, next, next + up}, {k, next + up, k + up}, {n, next, k}, {n + up, k + up, next + up}});
  }
  return mesh;
}

Mesh capsule_mesh(double length, double radius, std::size_t triangles) {
  Mesh mesh = meshes::bumpy_sphere(radius, 0, 1, triangles);
  for (Vec3& v : mesh.vertices) v.z() += std::copysign(length / 2, v.z());
  return mesh;
}

Mesh casting(const Vec3& widths, int waves, std::size_t triangles) {
  Mesh mesh = meshes::bumpy_sphere(1, 0.03, waves, triangles);
  for (Vec3& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) v[k] = std::copysign(std::sqrt(std::abs(v[k])), v[k]) * widths[k] / 2;
  return mesh;
}

Solid Solid::placed(const Vec3& position, const Mat3& rotation) && {
  at = {position, rotation};
  return std::move(*this);
}

Solid solid_box(const Vec3& w) {
  const Vec3 square = w.cwiseProduct(w) / 12;
  return {Shape::rounded_box(w, rounding), w.prod(), Vec3::Constant(square.sum()) - square, meshes::box(w)};
}

// A prism, so wide that its volume is the cylinder's.
Solid solid_cylinder(double radius, double height, int sides) {
  const double corner = radius * std::sqrt(2 * pi / sides / std::sin(2 * pi / sides));
  Mesh core = cylinder_mesh(corner - rounding, height - 2 * rounding, sides);
  std::erase_if(core.vertices, [](const Vec3& v) { return v.x() == 0 && v.y() == 0; });
  const double across = radius * radius / 4 + height * height / 12;
  return {Shape::hull(core.vertices, rounding),
          pi * radius * radius * height,
          {across, across, radius * radius / 2},
          cylinder_mesh(corner, height, sides)};
}

Solid solid_bar(double length, double radius) {
  Solid bar = solid_cylinder(radius, length);
  Mesh mesh;
  append(mesh, capsule_mesh(length - 2 * radius, radius, 400), {Vec3::Zero(), z_to_y()});
  bar.shape = Shape::capsule(length - 2 * radius, radius);  // along y
  bar.gyration = Vec3(bar.gyration.x(), bar.gyration.z(), bar.gyration.y());
  bar.mesh = mesh;
  bar.at.rotation = z_to_y().transpose();
  return bar;
}

Solid solid_ball(double radius) {
  return {Shape::sphere(radius), 4 * pi / 3 * std::pow(radius, 3), Vec3::Constant(0.4 * radius * radius),
          meshes::bumpy_sphere(radius, 0, 1, 500)};
}

Object loose(const std::string& name, double mass, const std::vector<Solid>& solids, const Vec3& origin,
             const Mat3& rotation) {
  double volume = 0;
  Vec3 centre = Vec3::Zero();
  for (const Solid& s : solids) volume += s.volume, centre += s.volume * s.at.position;
  centre /= volume;
  Mat3 inertia = Mat3::Zero();
  for (const Solid& s : solids) {
    const double m = mass * s.volume / volume;
    const Vec3 d = s.at.position - centre;
    inertia += m * (s.at.rotation * s.gyration.asDiagonal() * s.at.rotation.transpose() +
                    d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  }
  Mat3 principal = Mat3::Identity();
  if (!inertia.isDiagonal(1e-12)) {
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
    principal = eigen.eigenvectors();
    if (principal.determinant() < 0) principal.col(0) *= -1;
    inertia = eigen.eigenvalues().asDiagonal();
  }
  Object object{.name = name, .mass = mass, .inertia = inertia.diagonal().asDiagonal()};
  Mesh mesh;
  for (const Solid& s : solids) {
    const Pose<double> at{principal.transpose() * (s.at.position - centre), principal.transpose() * s.at.rotation};
    object.pieces.push_back({s.shape, at});
    append(mesh, s.mesh, at);
  }
  object.mesh = tree_of(mesh);
  object.pose = {origin + rotation * centre, rotation * principal};
  return object;
}

Object fixed(const std::string& name, TreePointer mesh, const Vec3& position, const Mat3& rotation) {
  return {.name = name, .mesh = std::move(mesh), .pose = {position, rotation}};
}

Object table(const std::string& name, const Vec3& widths, const Vec3& top, std::size_t triangles) {
  Object object = fixed(name, tree_of(meshes::plate(widths, triangles)), top - widths.z() / 2 * Vec3::UnitZ());
  object.pieces = {{Shape::rounded_box(widths, rounding)}};
  return object;
}

std::vector<Object> laid_out(const std::vector<NamedTree>& parts, double row) {
  constexpr double apart = 0.004;  // m
  std::vector<Object> objects;
  double x = 0, y = 0, deepest = 0;
  for (const auto& [name, part] : parts) {
    const Vec3 size = part->box().sizes();
    if (x > 0 && x + size.x() > row) x = 0, y += deepest + apart, deepest = 0;
    const Vec3 corner(x, y, 0), top(part->box().min().x(), part->box().min().y(), part->box().max().z());
    objects.push_back(fixed(name, part, corner - top));
    x += size.x() + apart;
    deepest = std::max(deepest, size.y());
  }
  return objects;
}

void lift_clear(Surroundings& surroundings) {
  collision::World world;
  std::uint64_t bit = 1;
  const Object* last = nullptr;
  const Scenery scenery(world, surroundings, [&](const Object& object) -> Scenery::Role {
    if (!object.loose()) return {};
    if (&object != last && bit >> 62) throw std::runtime_error(surroundings.name + ": more than 62 loose objects");
    if (std::exchange(last, &object) != &object) bit *= 2;
    return {{bit, ~bit}, true};
  });
  std::vector<double> lifted(surroundings.objects.size(), 0);
  for (int round = 0;; ++round) {
    const collision::Touch* deepest = nullptr;
    for (const collision::Touch& touch : world.touches(1e-4))
      if (touch.gap < 2e-5 && (!deepest || touch.gap < deepest->gap)) deepest = &touch;
    if (!deepest) return;
    const auto a = at(scenery.object_of(deepest->a)), b = at(scenery.object_of(deepest->b));
    // The higher one is lifted.
    const bool second = surroundings.objects[b].loose() &&
                        surroundings.objects[b].pose.position.z() > surroundings.objects[a].pose.position.z();
    const std::size_t k = second || !surroundings.objects[a].loose() ? b : a;
    const double lift = std::max(1e-4 - deepest->gap, 1e-4);
    lifted[k] += lift;
    if (lifted[k] > 0.005 || round > 1000)
      throw std::runtime_error(surroundings.name + ": the loose object '" + surroundings.objects[k].name +
                               "' overlaps '" + surroundings.objects[k == a ? b : a].name +
                               "' and is not clear of it 5 mm higher either");
    surroundings.objects[k].pose.position.z() += lift;
    scenery.place(world, k, surroundings.objects[k].pose);
  }
}

}  // namespace zwang::god
