#include <zwang/collision/mesh_file.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>

#include <zwang/core/problem/did_you_mean.h>

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw BadFile(file.string() + ": " + one_line(why));
}

// assimp calls what it reads from memory "$$$___magic___$$$.stl".
std::string without_placeholder(std::string text) {
  const std::size_t at = text.find("$$$___magic___$$$"), end = std::min(text.size(), text.find(' ', at));
  return at == std::string::npos ? text : text.replace(at, end - at, "it");
}

// Meshes belong to nodes, and each node is placed relative to its parent.
void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4t<double>& to_parent, double unit, Mesh& mesh) {
  const aiMatrix4x4t<double> to_root = to_parent * aiMatrix4x4t<double>(node.mTransformation);
  for (unsigned int m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
    if (offset == 0) mesh.vertices.reserve(part.mNumVertices), mesh.triangles.reserve(part.mNumFaces);
    for (unsigned int v = 0; v < part.mNumVertices; ++v) {
      const aiVector3t<double> p = to_root * aiVector3t<double>(part.mVertices[v]);
      mesh.vertices.emplace_back(unit * p.x, unit * p.y, unit * p.z);
    }
    for (unsigned int f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<std::uint32_t, 3> t;
      for (unsigned int k = 0; k < 3; ++k)  // an index of another part would look sound
        t[k] = face.mIndices[k] < part.mNumVertices ? offset + face.mIndices[k] : ~std::uint32_t{0};
      mesh.triangles.push_back(t);
    }
  }
  for (unsigned int c = 0; c < node.mNumChildren; ++c) append(scene, *node.mChildren[c], to_root, unit, mesh);
}

// What assimp makes of a file's contents, one mesh.
Mesh parse(const StoredFile& stored, const std::string& kind, const std::string& bytes, double unit) {
  const fs::path& file = stored.path;
  if (kind == ".ply" && bytes.find("end_header") == std::string::npos)
    refuse(file, "cut within its header; expected a line end_header");
  Assimp::Importer importer;
  constexpr unsigned int steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure;
  // A glTF's buffers lie in files beside it, so that one is read from its place.
  const bool beside = kind == ".gltf" && !stored.packed();
  const aiScene* scene = beside ? importer.ReadFile(file.string(), steps)
                                : importer.ReadFileFromMemory(bytes.data(), bytes.size(), steps, kind.c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr) refuse(file, without_placeholder(importer.GetErrorString()));
  Mesh mesh;
  append(*scene, *scene->mRootNode, aiMatrix4x4t<double>(), unit, mesh);
  return mesh;
}

}  // namespace

double metres_per(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> units{
      {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};
  std::vector<std::string> names;
  for (const auto& [name, metres] : units) {
    if (name == unit) return metres;
    names.emplace_back(name);
  }
  throw std::invalid_argument("no unit '" + std::string(unit) + "'" + did_you_mean(std::string(unit), names) +
                              " (m, cm, mm, um, in, ft)");
}

MeshName parse_mesh_name(const std::string& name) {
  const std::size_t at = name.rfind('@');
  std::error_code ignored;
  if (at == std::string::npos || fs::exists(name, ignored)) return {name};
  try {
    return {name.substr(0, at), metres_per(name.substr(at + 1))};
  } catch (const std::invalid_argument& wrong) {
    throw BadFile(name + ": " + wrong.what());
  }
}

MeshFile read_mesh(const StoredFile& stored, const MeshFileOptions& options) {
  constexpr std::size_t most = std::size_t{4} << 30;  // bytes, unpacked
  constexpr std::array<std::string_view, 6> kinds{".stl", ".obj", ".ply", ".gltf", ".glb", ".dxf"};
  const std::string kind = stored.kind();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    refuse(stored.path, "meshes are .stl, .obj, .ply, .gltf, .glb or .dxf, or one of them with .gz");
  const std::string inner = stored.packed() ? unpacked(stored, most) : std::string();
  MeshFile out{.mesh = parse(stored, kind, stored.packed() ? inner : stored.bytes, options.unit)};
  if (out.mesh.triangles.empty()) refuse(stored.path, "no triangles in it");
  try {
    out.report = clean(out.mesh, options.weld);
  } catch (const std::invalid_argument& bad) {
    refuse(stored.path, bad.what());
  }
  return out;
}

}  // namespace zwang::collision
