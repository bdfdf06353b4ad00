#include <zwang/bench/collision/drag_scenes.h>

#include <cmath>
#include <numbers>

#include <zwang/bench/collision/meshes.h>
#include <zwang/collision/load.h>

namespace zwang {
namespace {

namespace fs = std::filesystem;
using collision::Mesh;
using Tree = std::shared_ptr<const collision::Tree>;

Tree tree(const Mesh& mesh) { return std::make_shared<const collision::Tree>(mesh); }

std::vector<Tree> repeated(const Tree& tree, int count) {
  return std::vector<Tree>(static_cast<std::size_t>(count), tree);
}

void add(std::vector<Tree>& to, const std::vector<Tree>& more) { to.insert(to.end(), more.begin(), more.end()); }

constexpr std::array differential{"ring",          "pinion", "spider",     "side",      "carrier",
                                  "carrier_cover", "arm",    "rightshaft", "leftshaft", "motor_cover"};

// All ten files as one part: they share one frame.
Tree whole_differential(const fs::path& data) {
  Mesh all;
  for (const char* name : differential) {
    const Mesh mesh =
        collision::read_mesh(data / "mesh_differential" / ("diff_" + std::string(name) + ".stl"), {.unit = 1e-3}).mesh;
    const auto offset = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& t : mesh.triangles) all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return tree(all);
}

std::vector<Part> real_100k(const fs::path& data, const fs::path& cache) {
  std::vector<Tree> trees;
  for (std::size_t k = 0; k < 5; ++k)
    trees.push_back(std::make_shared<const collision::Tree>(
        collision::load_tree(data / "mesh_differential" / ("diff_" + std::string(differential[k]) + ".stl"),
                             {.unit = 1e-3, .cache = cache})
            .tree));
  return laid_out(trees, 0.25);
}

std::vector<Part> real_1m(const fs::path& data, const fs::path& cache) {
  const auto load = [&](const char* file, double unit) {
    return std::make_shared<const collision::Tree>(
        collision::load_tree(data / file, {.unit = unit, .cache = cache}).tree);
  };
  std::vector<Tree> trees = repeated(whole_differential(data), 3);
  add(trees, repeated(load("mesh_cad_misc/counter.unitsmm.STL.gz", 1e-3), 2));
  add(trees, repeated(load("mesh_cad_misc/cycloidal.ply.gz", 0.0254), 3));
  add(trees, repeated(load("mesh_factory_parts/factory_gear_medium_space_5e-4.obj.gz", 1), 3));
  add(trees, repeated(load("mesh_factory_parts/factory_bolt_m20_loose.obj.gz", 1), 4));
  add(trees, repeated(load("mesh_factory_parts/factory_bolt_m8_loose.obj.gz", 1), 3));
  add(trees, repeated(load("mesh_factory_parts/factory_bolt_m16_loose.obj.gz", 1), 2));
  return laid_out(trees, 0.65);
}

std::vector<Part> procedural(int count, std::size_t triangles, double row) {
  std::vector<Tree> trees;
  for (int k = 0; k < count; ++k) switch (k % 5) {
      case 0:
        trees.push_back(tree(meshes::gear(0.05, 0.02, 18, triangles)));
        break;
      case 1:
        trees.push_back(tree(meshes::pipe(0.03, 0.004, 0.08, triangles)));
        break;
      case 2:
        trees.push_back(tree(meshes::perforated({0.14, 0.12, 0.01}, 5, triangles)));
        break;
      case 3:
        trees.push_back(tree(meshes::bumpy_sphere(0.05, 0.003, 8, triangles)));
        break;
      default:
        trees.push_back(tree(meshes::plate({0.12, 0.12, 0.02}, triangles)));
        break;
    }
  return laid_out(trees, row);
}

// Bars along x to close the hand about, 0.1 m thick. `outline` [m]: radius at an angle about x and a place along it.
Tree bar(const std::function<double(double angle, double x)>& outline, std::size_t triangles) {
  Mesh mesh = meshes::pipe(0.05, 0.01, 0.6, triangles);
  for (Vec3& p : mesh.vertices) {
    const double angle = std::atan2(p.y(), p.x()), share = std::hypot(p.x(), p.y()) / 0.05;
    const double radius = share * outline(angle, p.z());
    p = {p.z(), radius * std::cos(angle), radius * std::sin(angle)};
  }
  return tree(mesh);
}

// A sheet rolled up.
Tree tube(std::size_t triangles) {
  Mesh mesh = meshes::sheet(0.6, 2 * std::numbers::pi * 0.05, triangles);
  for (Vec3& p : mesh.vertices) p = {p.x(), 0.05 * std::sin(p.y() / 0.05), 0.05 * std::cos(p.y() / 0.05)};
  return tree(mesh);
}

std::vector<DragOptions> gripping(std::initializer_list<double> speeds) {
  std::vector<DragOptions> runs;
  for (const double v : speeds) runs.push_back({.speed = v, .grip = 0.6});
  return runs;
}

std::vector<DragOptions> at_speeds(std::initializer_list<double> speeds) {
  std::vector<DragOptions> runs;
  for (const double v : speeds) runs.push_back({.speed = v});
  return runs;
}

}  // namespace

std::vector<Part> laid_out(const std::vector<Tree>& trees, double row) {
  std::vector<Part> parts;
  double x = 0, y = 0, deepest = 0;
  for (const Tree& t : trees) {
    const Vec3 size = t->high() - t->low();
    if (x > 0 && x + size.x() > row) x = 0, y += deepest + 0.004, deepest = 0;
    const Vec3 corner(x, y, 0), top(t->low().x(), t->low().y(), t->high().z());
    parts.push_back({t, {corner - top, Mat3::Identity()}});
    x += size.x() + 0.004;
    deepest = std::max(deepest, size.y());
  }
  return parts;
}

std::vector<DragScene> drag_scenes(const fs::path& data, const fs::path& cache) {
  const bool real = fs::exists(data / "mesh_differential") && fs::exists(data / "mesh_factory_parts");
  std::vector<DragScene> scenes;
  scenes.push_back({"100k triangles, 5 parts", real ? "real: a differential" : "procedural", at_speeds({0.5, 1, 2}),
                    1000, [=] { return real ? real_100k(data, cache) : procedural(5, 20000, 0.25); }});
  scenes.push_back({"1M triangles, 20 parts", real ? "real: differentials, gears, bolts, counter tops" : "procedural",
                    at_speeds({0.5, 1, 2}), 1500,
                    [=] { return real ? real_1m(data, cache) : procedural(20, 50000, 0.5); }});
  scenes.push_back({"1M triangles, 20 procedural parts", "gears, pipes, plates, bumpy spheres", at_speeds({0.5}), 1000,
                    [] { return procedural(20, 50000, 0.5); }});
  scenes.push_back(
      {"three parts of 400k triangles", "gear, perforated plate, bumpy sphere", at_speeds({0.5, 2}), 1000, [] {
         return laid_out(
             {tree(meshes::gear(0.1, 0.03, 24, 400000)), tree(meshes::perforated({0.22, 0.2, 0.01}, 6, 400000)),
              tree(meshes::bumpy_sphere(0.1, 0.004, 9, 400000))},
             1);
       }});
  scenes.push_back({"fine plate", "100k triangles, flat", at_speeds({0.5, 2}), 800,
                    [] { return laid_out({tree(meshes::plate({0.4, 0.4, 0.02}, 100000))}, 1); }});
  scenes.push_back({"sheet without thickness", "20k triangles", at_speeds({1, 5}), 1200,
                    [] { return laid_out({tree(meshes::sheet(0.5, 0.5, 20000))}, 1); }});
  scenes.push_back({"slivers", "20k triangles of 1 : 3000", at_speeds({0.5, 5}), 800,
                    [] { return laid_out({tree(meshes::slivers(0.3, 0.01, 20000))}, 1); }});
  scenes.push_back({"plate with holes", "50k triangles", at_speeds({1, 5}), 500,
                    [] { return laid_out({tree(meshes::perforated({0.4, 0.4, 0.01}, 8, 50000))}, 1); }});
  scenes.push_back(
      {"turning 0.5 rad a frame", "bumpy sphere and plate of 50k triangles", {{.speed = 1, .spin = 0.5}}, 500, [] {
         return laid_out(
             {tree(meshes::bumpy_sphere(0.12, 0.006, 8, 50000)), tree(meshes::plate({0.3, 0.3, 0.02}, 50000))}, 1);
       }});
  scenes.push_back(
      {"moving parts", "plate, gear and sphere of 20k triangles, to 0.3 m/s and 3 rad/s", at_speeds({0.5, 2}), 800, [] {
         auto parts = laid_out({tree(meshes::plate({0.3, 0.3, 0.02}, 20000)), tree(meshes::gear(0.08, 0.02, 18, 20000)),
                                tree(meshes::bumpy_sphere(0.08, 0.004, 8, 20000))},
                               1);
         parts[0].velocity << 0.1, 0, 0.3, 0, 0, 0;
         parts[1].velocity << 0, 0.2, 0, 0, 0, 3;
         parts[2].velocity << 0, 0, 0.1, 2, 0, 0;
         return parts;
       }});
  scenes.push_back({"gripped pipe", "100k triangles, smooth", gripping({0.5, 2}), 2500,
                    [] { return laid_out({bar([](double, double) { return 0.05; }, 100000)}, 1); }});
  scenes.push_back(
      {"gripped bumpy bar", "60k triangles", gripping({0.5, 2}), 2500, [] {
         return laid_out(
             {bar([](double angle, double x) { return 0.05 * (1 + 0.05 * std::sin(6 * angle) * std::sin(120 * x)); },
                  60000)},
             1);
       }});
  scenes.push_back({"gripped shaft with teeth", "100k triangles", gripping({0.5, 2}), 2500, [] {
                      Mesh shaft = meshes::gear(0.055, 0.6, 30, 100000);
                      for (Vec3& p : shaft.vertices) p = Vec3(p.z(), p.x(), p.y());
                      return laid_out({tree(shaft)}, 1);
                    }});
  scenes.push_back({"gripped tube of a sheet without thickness", "30k triangles", gripping({1, 5}), 2500,
                    [] { return laid_out({tube(30000)}, 1); }});
  return scenes;
}

}  // namespace zwang
