#include <zwang/bench/collision/meshes.h>
#include <zwang/experiments/god_hand/scenes/scene_objects.h>

namespace zwang::god {

void add_small_parts(Surroundings& s, const Vec3& on) {
  const Vec3 base = on + Vec3(0, 0, 1e-4);
  s.objects.push_back(loose("cap", 0.1, {solid_cylinder(0.022, 0.02).placed({0, 0, 0.01})}, base + Vec3(-0.045, 0, 0)));
  s.objects.push_back(
      loose("relay", 0.08, {solid_box({0.03, 0.03, 0.025}).placed({0, 0, 0.0125})}, base + Vec3(0.005, 0.01, 0)));
  s.objects.push_back(loose(
      "bolt", 0.06,
      {solid_cylinder(0.011, 0.01, 6).placed({0, 0, 0.005}), solid_cylinder(0.006, 0.032, 8).placed({0, 0, 0.025})},
      base + Vec3(0.05, -0.005, 0)));
}

void add_box_and_can(Surroundings& s, const Vec3& box, const Vec3& can) {
  s.objects.push_back(loose("box", 0.2, {solid_box({0.05, 0.05, 0.05}).placed({0, 0, 0.025})}, box + Vec3(0, 0, 1e-4)));
  s.objects.push_back(loose("can", 0.2, {solid_cylinder(0.02, 0.06).placed({0, 0, 0.03})}, can + Vec3(0, 0, 1e-4)));
}

// The paper's simple scene has five physics objects, 100,000 triangles, the largest part 30,000. Here the five detailed
// meshes are fixed, since loose objects are convex pieces for hands and engine alike; a box and a can beside them are
// loose. All stand on a table.
Surroundings simple_scene() {
  Surroundings s{.name = "simple"};
  s.objects = {table("table", {0.6, 0.5, 0.03}, {0, 0, 0}, 5000),
               fixed("gear", tree_of(meshes::gear(0.055, 0.03, 18, 30000)), {0, 0, 0.015}),
               fixed("pipe", tree_of(meshes::pipe(0.02, 0.004, 0.14, 20000)), {0.085, 0.005, 0.02}, z_to_y()),
               fixed("dome", tree_of(meshes::bumpy_sphere(0.045, 0.0025, 9, 20000)), {-0.075, 0.075, 0.002}),
               fixed("grating", tree_of(meshes::perforated({0.12, 0.09, 0.034}, 3, 17000)), {0.015, 0.108, 0.017}),
               fixed("casting", tree_of(casting({0.11, 0.06, 0.05}, 8, 10000)), {-0.03, -0.09, 0.02})};
  add_box_and_can(s, {-0.1, 0, 0}, {0.075, -0.105, 0});
  s.focus = surface_at(s, 0.03, 0.02);
  return s;
}

// An engine seen from above, in a bay of 0.6 x 0.5 m: a block with holes; on it two head covers with four intake
// runners across the valley between them; a plenum, three timing gears and a pulley at the front, an alternator,
// exhaust stubs at the back, a grating, bolts. A tray holds what is loose. Parts that repeat share one tree.
Surroundings engine_scene() {
  Surroundings s{.name = "engine"};
  const auto add = [&s](const std::string& name, const TreePointer& mesh, const Vec3& at,
                        const Mat3& rotation = Mat3::Identity()) {
    s.objects.push_back(fixed(name, mesh, at, rotation));
  };
  add("block", tree_of(meshes::perforated({0.56, 0.42, 0.05}, 7, 128000)), {0, 0, -0.095});
  const TreePointer cover = tree_of(casting({0.31, 0.09, 0.07}, 12, 70000));
  add("left head cover", cover, {0, 0.09, -0.035});
  add("right head cover", cover, {0, -0.05, -0.035});
  const TreePointer runner = tree_of(meshes::pipe(0.018, 0.003, 0.17, 50000));
  for (int k = 0; k < 4; ++k)
    add("intake runner " + std::to_string(k + 1), runner, {-0.105 + 0.07 * k, 0.02, 0.014}, z_to_y());
  add("plenum", tree_of(casting({0.08, 0.24, 0.07}, 10, 90000)), {0.215, 0.03, -0.03});
  add("cam gear", tree_of(meshes::gear(0.055, 0.018, 26, 90000)), {-0.07, -0.15, -0.05}, z_to_y());
  const TreePointer idler = tree_of(meshes::gear(0.036, 0.016, 17, 50000));
  add("idler gear", idler, {0.022, -0.15, -0.045}, z_to_y());
  add("crank gear", idler, {0.09, -0.15, -0.05}, z_to_y());
  add("pulley", tree_of(meshes::pipe(0.045, 0.03, 0.025, 40000)), {-0.07, -0.185, -0.05}, z_to_y());
  add("alternator", tree_of(meshes::bumpy_sphere(0.052, 0.003, 10, 90000)), {-0.22, 0.07, -0.04});
  const TreePointer stub = tree_of(meshes::pipe(0.02, 0.003, 0.09, 40000));
  for (int k = 0; k < 3; ++k) add("exhaust stub " + std::to_string(k + 1), stub, {-0.08 + 0.08 * k, 0.168, -0.03});
  add("grating", tree_of(meshes::perforated({0.1, 0.12, 0.05}, 4, 32000)), {-0.225, -0.08, -0.0455});
  const TreePointer bolt = tree_of(meshes::gear(0.01, 0.01, 6, 10000));
  for (int k = 0; k < 4; ++k)
    add("bolt " + std::to_string(k + 1), bolt, {k % 2 ? 0.13 : -0.13, k < 2 ? 0.115 : -0.075, 0.002});
  s.objects.push_back(table("tray", {0.16, 0.09, 0.012}, {0.2, -0.15, -0.012}, 10000));
  add_small_parts(s, {0.2, -0.15, -0.012});
  s.focus = surface_at(s, -0.035, 0.02);
  return s;
}

Surroundings detailed_scene() {
  Surroundings s{.name = "detailed",
                 .objects = laid_out({{"gear", tree_of(meshes::gear(0.1, 0.03, 24, 400000))},
                                      {"perforated plate", tree_of(meshes::perforated({0.22, 0.2, 0.01}, 6, 450000))},
                                      {"bumpy sphere", tree_of(meshes::bumpy_sphere(0.1, 0.004, 9, 400000))}},
                                     1)};
  s.focus = busiest_place(s);
  return s;
}

}  // namespace zwang::god
