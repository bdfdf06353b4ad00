#include <zwang/experiments/god_hand/scenes/scenes.h>

#include <algorithm>
#include <stdexcept>

#include <zwang/bench/collision/meshes.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/scenes/scene_objects.h>

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

// A slab that is far larger than a hand; its upper side, the wall, is the plane z = 0.
Surroundings wall() {
  return {.name = "wall", .objects = {fixed("wall", tree_of(meshes::plate({0.5, 0.5, 0.04}, 20000)), {0, 0, -0.02})}};
}

Surroundings plate() {
  return {.name = "plate", .objects = {fixed("sheet", tree_of(meshes::sheet(0.5, 0.5, 20000)), Vec3::Zero())}};
}

// The hand works on the table beside the box: a slide along +x pushes it.
Surroundings box() {
  return {.name = "box",
          .objects = {table("table", {0.8, 0.5, 0.03}, Vec3::Zero(), 15000),
                      loose("box", 0.2, {solid_box({0.07, 0.09, 0.06})}, {0.13, 0.03, 0.0301})}};
}

Surroundings pegs() {
  constexpr int count = 8;
  constexpr double apart = 0.034, height = 0.07, radius = 0.008;
  Surroundings s{.name = "pegs"};
  s.objects = {table("base", {0.4, 0.36, 0.02}, {0, 0, -height}, 8000)};
  const TreePointer peg = tree_of(capsule_mesh(height - 2 * radius, radius, 3000));
  for (int k = 0; k < count; ++k)
    s.objects.push_back(fixed("peg " + std::to_string(k + 1), peg, {(k - (count - 1) / 2.0) * apart, 0, -height / 2}));
  s.objects.push_back(
      fixed("plate with holes", tree_of(meshes::perforated({0.3, 0.12, 0.008}, 4, 10000)), {0, 0.1, -0.015}));
  s.focus = {apart / 2, 0, 0};
  return s;
}

Surroundings holes() {
  return {.name = "holes",
          .objects = {fixed("plate", tree_of(meshes::perforated({0.4, 0.4, 0.01}, 8, 64000)), {0, 0, -0.005})}};
}

// Without friction a hand holds only what it encloses or hooks: a bar over the ground between two blocks for the
// fingers to close about, a mug by its handle, a T to lift by its arms.
Surroundings grasp() {
  Surroundings s{.name = "table"};
  const auto bar = [](double x, double y, double z) {
    return solid_bar(0.16, 0.01).placed({x, y, z}, z_to_x() * z_to_y().transpose());
  };
  s.objects.push_back(table("table", {0.8, 0.6, 0.03}, {0, 0, -0.06}, 12000));
  const auto stand = [&](const std::string& name, double mass, std::vector<Solid> solids, double x, double y) {
    s.objects.push_back(loose(name, mass, solids, {x, y, -0.06 + 1e-4}));
  };
  stand("dumbbell", 0.3,
        {solid_box({0.03, 0.07, 0.07}).placed({-0.08, 0, 0.035}),
         solid_box({0.03, 0.07, 0.07}).placed({0.08, 0, 0.035}), bar(0, 0, 0.05)},
        0, 0);
  stand("mug", 0.25,
        {solid_cylinder(0.038, 0.09).placed({0, 0, 0.045}), solid_box({0.03, 0.012, 0.012}).placed({0.048, 0, 0.078}),
         solid_box({0.03, 0.012, 0.012}).placed({0.048, 0, 0.012}),
         solid_box({0.012, 0.012, 0.078}).placed({0.069, 0, 0.045})},
        0.18, 0.06);
  stand("T", 0.2,
        {solid_box({0.08, 0.06, 0.012}).placed({0, 0, 0.006}), solid_box({0.016, 0.016, 0.07}).placed({0, 0, 0.045}),
         bar(0, 0, 0.085)},
        -0.22, 0.06);
  stand("box", 0.15, {solid_box({0.05, 0.05, 0.05}).placed({0, 0, 0.025})}, 0.18, -0.14);
  stand("can", 0.2, {solid_cylinder(0.03, 0.08).placed({0, 0, 0.04})}, -0.16, -0.14);
  stand("ball", 0.1, {solid_ball(0.03).placed({0, 0, 0.03})}, 0, -0.18);
  s.focus = {0, 0, 0};
  return s;
}

// For --god peg, whose radius is 10 mm.
Surroundings hole() {
  constexpr double outer = 0.03, bore = 0.0103, length = 0.04;
  return {.name = "hole",
          .objects = {fixed("bushing", tree_of(meshes::pipe(outer, outer - bore, length, 20000)), {0, 0, -length / 2})},
          .focus = {(outer + bore) / 2, 0, 0}};
}

// For --god key: a plate with a slot that its bit fits through, and room behind it.
Surroundings lock() {
  constexpr double thick = 0.008, half = 0.04, low_x = -0.0034, high_x = 0.0155, half_y = 0.0034, rounding = 5e-4;
  Surroundings s{.name = "lock"};
  Object plate{.name = "plate", .pose = {{0, 0, -thick / 2}, Mat3::Identity()}};
  const auto add = [&](double x0, double x1, double y0, double y1) {
    plate.pieces.push_back({collision::Shape::rounded_box({x1 - x0, y1 - y0, thick}, rounding),
                            {{(x0 + x1) / 2, (y0 + y1) / 2, 0}, Mat3::Identity()}});
  };
  add(-half, low_x, -half, half);
  add(high_x, half, -half, half);
  add(low_x - 2 * rounding, high_x + 2 * rounding, half_y, half);
  add(low_x - 2 * rounding, high_x + 2 * rounding, -half, -half_y);
  s.objects = {plate};
  s.focus = {-half / 2, 0, 0};
  return s;
}

struct SceneEntry {
  const char* name;
  const char* line;
  Surroundings (*make)();
  Surroundings (*of_real_parts)(const fs::path& folder) = nullptr;
};
constexpr SceneEntry scene_entries[] = {
    {"wall", "a flat wall, 20k triangles", wall},
    {"plate", "a sheet without thickness, 20k triangles", plate},
    {"box", "a box of 0.2 kg to push over a table", box},
    {"pegs", "a row of pegs and a plate with holes, fingers fit between and through", pegs},
    {"holes", "a plate with holes, 50k triangles", holes},
    {"grasp", "dumbbell, mug, T, box, can and ball, loose on a table", grasp},
    {"hole", "a bushing for --god peg: 0.3 mm of clearance at a radius of 10 mm", hole},
    {"lock", "a plate with a slot for --god key, to be turned behind it", lock},
    {"simple", "five detailed parts, 100k triangles, and two loose ones (the paper's simple scene)", simple_scene,
     real_simple_scene},
    {"engine", "an engine compartment, 20 parts, 1M triangles, and loose small ones", engine_scene, real_engine_scene},
    {"detailed", "three parts of 400k triangles", detailed_scene}};

}  // namespace

std::vector<std::pair<std::string, std::string>> scenes() {
  return mapped(scene_entries, [](const SceneEntry& e) { return std::pair<std::string, std::string>(e.name, e.line); });
}

Surroundings make_surroundings(const std::string& scene, const fs::path& parts) {
  const auto entry = std::ranges::find(scene_entries, scene, &SceneEntry::name);
  if (entry != std::end(scene_entries)) {
    if (!parts.empty() && !entry->of_real_parts)
      throw std::invalid_argument("scene '" + scene + "' is not made of real parts; 'simple' and 'engine' are");
    Surroundings s = parts.empty() ? entry->make() : entry->of_real_parts(parts);
    lift_clear(s);
    return s;
  }
  if (scene.find_first_of(".,@/") == std::string::npos)
    throw std::invalid_argument("no scene '" + scene + "'" +
                                did_you_mean(scene, names_of(scene_entries, &SceneEntry::name)) +
                                " (./zwang simulate --help lists all)");
  if (!parts.empty()) throw std::invalid_argument("files are a scene of their own, without a folder of parts");
  return files_scene(scene);
}

SceneSize size_of(const Surroundings& surroundings) {
  SceneSize size;
  for (const Object& object : surroundings.objects) {
    ++(object.loose() ? size.loose : size.fixed);
    if (!object.loose() && object.mesh) size.triangles += object.mesh->size();
  }
  return size;
}

}  // namespace zwang::god
