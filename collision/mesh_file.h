#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include <zwang/collision/mesh.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>

namespace zwang::collision {

struct MeshFileOptions {
  double unit = 1;  // m per unit of the file's coordinates (glTF is in metres; the other formats do not say)
  double weld = 0;  // of the file's coordinates, after the unit [m]; 0: only equal vertices
  std::filesystem::path cache = {};  // folder of flattened trees; empty: none
  std::function<void(double fraction, std::string_view stage)> progress = {};
};

// "mm" -> 0.001. Throws std::invalid_argument with the nearest name.
double metres_per(std::string_view unit);

// "gear.stl@mm": a file and the unit of its coordinates, without @ metres. Throws BadFile for an unknown unit.
struct MeshName {
  std::filesystem::path file = {};
  double unit = 1;  // m
};
MeshName parse_mesh_name(const std::string& name);

struct MeshFile {
  Mesh mesh = {};
  MeshReport report = {};
};

// STL, OBJ, PLY, glTF/GLB, DXF, each also as .gz. Node transforms are applied, polygons cut into triangles, points and
// lines skipped. Throws BadFile, one line: the file and what is wrong with it. assimp reads some damaged files for
// ever: load_tree (load.h) calls this in a child process.
MeshFile read_mesh(const StoredFile& file, const MeshFileOptions& options = {});
inline MeshFile read_mesh(const std::filesystem::path& file, const MeshFileOptions& options = {}) {
  return read_mesh(read_stored(file), options);
}

}  // namespace zwang::collision
