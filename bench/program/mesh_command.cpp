#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/collision/load.h>

namespace zwang {

int mesh_command(std::vector<std::string> words) {
  CLI::App options("Loads a mesh as the simulation would, and says what is in it and what was mended.");
  introduce(options, "mesh",
            "  ./zwang mesh gear.stl@mm\n"
            "  ./zwang mesh engine.obj.gz --weld 1e-6");
  std::string name, unit;
  double weld = 0;
  options.add_option("FILE", name, "STL, OBJ, PLY, glTF/GLB or DXF; also .gz; FILE@mm: in millimetres")
      ->required()
      ->type_name("");
  options.add_option("--unit", unit, "of its coordinates, as after @: m (the default), cm, mm, um, in, ft");
  within(from(0, "m"),
         options.add_option("--weld", weld, "merge vertices nearer than this; default: equal ones alone"));
  if (!read(options, std::move(words))) return done;
  const collision::MeshName mesh = collision::parse_mesh_name(name);
  if (!unit.empty() && mesh.file != name) throw std::invalid_argument(name + " has its unit: --unit would be another");
  collision::MeshFileOptions how{
      .unit = unit.empty() ? mesh.unit : collision::metres_per(unit), .weld = weld, .cache = collision::tree_cache()};
  Progress bar;
  if (isatty(STDERR_FILENO) == 1)
    how.progress = [&](double fraction, std::string_view stage) { bar.show(fraction, std::string(stage)); };
  const collision::LoadedTree loaded = collision::load_tree(mesh.file, how);
  bar.clear();
  std::printf("%s\ntree: %.0f bytes a triangle%s\n", collision::to_string(loaded.report).c_str(),
              loaded.tree.bytes_per_triangle(), loaded.cached ? ", from the cache" : "");
  return done;
}

}  // namespace zwang
