#include <zwang/collision/mesh_file.h>

#include <openssl/evp.h>
#include <zlib.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/ProgressHandler.hpp>
#include <fstream>
#include <memory>

#include <zwang/core/problem/did_you_mean.h>

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  while (!why.empty() && why.back() == ' ') why.pop_back();
  throw BadFile(file.string() + ": " + why);
}

// assimp calls what it reads from memory "$$$___magic___$$$.stl".
std::string without_stand_in(std::string text) {
  const std::size_t at = text.find("$$$___magic___$$$"), end = std::min(text.size(), text.find(' ', at));
  return at == std::string::npos ? text : text.replace(at, end - at, "it");
}

std::string lower(std::string text) {
  for (char& ch : text)
    if (ch >= 'A' && ch <= 'Z') ch = static_cast<char>(ch - 'A' + 'a');
  return text;
}

std::string read_bytes(const fs::path& file) {
  if (fs::is_directory(file)) refuse(file, "a folder, not a file");
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) refuse(file, "no such file, or not readable");
  std::string bytes(static_cast<std::size_t>(in.tellg()), '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) refuse(file, "cannot be read to its end");
  if (bytes.empty()) refuse(file, "0 bytes");
  return bytes;
}

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, 32> digest;
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available");
  std::string text;
  for (const unsigned char byte : digest)
    for (const int digit : {byte >> 4, byte & 15}) text += "0123456789abcdef"[digit];
  return text;
}

struct Bar final : Assimp::ProgressHandler {
  const MeshFileOptions& options;
  explicit Bar(const MeshFileOptions& o) : options(o) {}
  bool Update(float fraction) override {
    if (options.progress) options.progress(0.5 * std::clamp(static_cast<double>(fraction), 0.0, 1.0), "reading");
    return true;
  }
};

// Meshes hang on nodes, each node moved against its parent.
void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4t<double>& to_parent, double unit, Mesh& mesh) {
  const aiMatrix4x4t<double> to_root = to_parent * aiMatrix4x4t<double>(node.mTransformation);
  for (unsigned int m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
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

std::string inflated(const fs::path& file, const std::string& bytes) {
  constexpr std::size_t most = std::size_t{4} << 30;
  z_stream stream = {};
  if (inflateInit2(&stream, 15 + 16) != Z_OK) refuse(file, "zlib cannot start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    const std::size_t have = out.size();
    if (have >= most) refuse(file, "inflates to more than 4 GB");
    out.resize(std::max<std::size_t>(2 * have, 4 * bytes.size() + 4096));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + have);
    stream.avail_out = static_cast<uInt>(out.size() - have);
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
    if (status != Z_OK && status != Z_STREAM_END) refuse(file, "not a whole gzip file");
  }
  return out;
}

StoredFile read_stored(const fs::path& file) {
  std::string bytes = read_bytes(file), hash = sha256(bytes);
  return {file, std::move(bytes), std::move(hash)};
}

MeshFile read_mesh(const StoredFile& stored, const MeshFileOptions& options) {
  const fs::path& file = stored.path;
  MeshFile out;
  const bool packed = lower(file.extension().string()) == ".gz";
  const std::string unpacked = packed ? inflated(file, stored.bytes) : std::string();
  const std::string& bytes = packed ? unpacked : stored.bytes;
  const std::string kind = lower((packed ? file.stem() : file).extension().string());
  constexpr std::array<std::string_view, 6> kinds{".stl", ".obj", ".ply", ".gltf", ".glb", ".dxf"};
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    refuse(file, "meshes are .stl, .obj, .ply, .gltf, .glb or .dxf, or one of them with .gz");

  Assimp::Importer importer;
  importer.SetProgressHandler(new Bar(options));  // the importer deletes it
  constexpr unsigned int steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure;
  // A glTF's buffers lie in files beside it, so that one is read from its place.
  const aiScene* scene = kind == ".gltf" && !packed
                             ? importer.ReadFile(file.string(), steps)
                             : importer.ReadFileFromMemory(bytes.data(), bytes.size(), steps, kind.c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr) refuse(file, without_stand_in(importer.GetErrorString()));
  append(*scene, *scene->mRootNode, aiMatrix4x4t<double>(), options.unit, out.mesh);
  importer.FreeScene();
  if (out.mesh.triangles.empty()) refuse(file, "no triangles in it");
  if (options.progress) options.progress(0.5, "welding");
  try {
    out.report = clean(out.mesh, options.weld);
  } catch (const std::invalid_argument& bad) {
    refuse(file, bad.what());
  }
  return out;
}

}  // namespace zwang::collision
