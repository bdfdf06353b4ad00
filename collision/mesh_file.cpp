#include <zwang/collision/mesh_file.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <cstring>
#include <iterator>
#include <sstream>

#include <zwang/core/problem/wording.h>

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw BadFile(file.string() + ": " + one_line(why));
}

// assimp calls what it reads from memory "$$$___magic___$$$.stl".
std::string without_placeholder(std::string text) {
  const std::size_t at = text.find("$$$___magic___$$$"), end = std::min(text.size(), text.find_first_of(" \"", at));
  return at == std::string::npos ? text : text.replace(at, end - at, "it");
}

std::size_t bytes_of_ply(std::string_view type) {
  for (const std::string_view one : {"char", "uchar", "int8", "uint8"})
    if (type == one) return 1;
  for (const std::string_view two : {"short", "ushort", "int16", "uint16"})
    if (type == two) return 2;
  return type == "double" || type == "float64" ? 8 : 4;
}

// How many of its words a line of text lacks: an element of these properties, of which true is a list and its length.
std::size_t words_missing(const std::string& line, const std::vector<bool>& lists) {
  std::istringstream words(line);
  std::string word;
  std::size_t wanted = 0, length = 0;
  for (const bool list : lists) {
    wanted += list && words >> length ? length : 1;
    for (; wanted > 0 && words >> word; --wanted) continue;
  }
  return wanted;
}

// Of text that ends early assimp makes a part of the mesh, and of triangle strips one triangle each.
void require_whole_ply(const fs::path& file, const std::string& ply) {
  const std::size_t end = ply.find("end_header");
  if (end == std::string::npos) refuse(file, "cut within its header; expected a line end_header");
  std::istringstream header(ply.substr(0, end));
  std::string line, last;
  std::vector<bool> lists;  // of the last element
  std::size_t wanted = 0, seen = 0, count = 0;
  bool text = false;
  while (std::getline(header, line)) {
    std::istringstream words(line);
    std::string word, name;
    words >> word >> name;
    text |= word == "format" && name == "ascii";
    if (word == "property" && count > 0) lists.push_back(name == "list");
    if (word != "element" || !(words >> count) || count == 0) continue;
    if (name == "tristrips") refuse(file, "its triangles are strips; expected an element face");
    wanted += count;
    lists.clear();
  }
  if (!text) return;
  std::istringstream data(ply.substr(ply.find('\n', end) + 1));
  while (std::getline(data, line))
    if (line.find_first_not_of(" \t\r") != std::string::npos) ++seen, last = line;
  if (seen < wanted || (seen == wanted && words_missing(last, lists) > 0))
    refuse(file, "cut: " + grouped(seen) + " lines of data; expected " + grouped(wanted) + " whole ones");
}

// assimp takes a first byte of binary data that is the end of a line, such as 0x0A in the float -0.02, for part of the
// header. Each vertex then gets another byte before it. "": the file as it is.
std::string with_first_byte_read(const std::string& ply) {
  const std::size_t end = ply.find("end_header"), data = ply.find('\n', end) + 1;
  if (ply.find("format binary") > end || data == 0 || data >= ply.size() || (ply[data] != '\n' && ply[data] != '\r'))
    return {};
  std::istringstream header(ply.substr(0, end));
  std::string out, line;
  std::size_t elements = 0, count = 0, record = 0;
  while (std::getline(header, line)) {
    std::istringstream words(line);
    std::string word, type;
    words >> word >> type;
    out += line + '\n';
    if (word == "element" && ++elements == 1) {
      words >> count;
      out += "property uchar first\n";
    }
    if (word != "property" || elements != 1) continue;
    if (type == "list") return {};
    record += bytes_of_ply(type);
  }
  if (count == 0 || record == 0 || count > (ply.size() - data) / record) return {};
  out += "end_header\n";
  for (std::size_t k = 0; k < count; ++k) out.append(1, 'x').append(ply, data + k * record, record);
  return out.append(ply, data + count * record);
}

// Text in small letters, which are all that assimp knows. "": the file as it is. Refuses what is neither text nor of
// the size of a binary STL: 80 bytes, the number of triangles, 50 bytes for each. Refuses text that ends early, too, of
// which assimp makes a part of the mesh: after the last facet stands endsolid (end solid, as some write).
std::string in_small_letters(const fs::path& file, const std::string& stl) {
  std::uint32_t triangles = 0;
  if (stl.size() >= 84) std::memcpy(&triangles, stl.data() + 80, sizeof triangles);
  const std::size_t wanted = 84 + 50 * std::size_t{triangles};
  if (wanted == stl.size()) return {};
  const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  const std::size_t first = std::min(stl.find_first_not_of(" \t\r\n"), stl.size());
  std::string word = stl.substr(first, 5);
  std::ranges::transform(word, word.begin(), lower);
  if (word != "solid")
    refuse(file,
           std::to_string(stl.size()) + " bytes; expected an STL: text that begins with solid, or " +
               (stl.size() < 84 ? "84 bytes at least"
                                : std::to_string(wanted) + " bytes for " + std::to_string(triangles) + " triangles"));
  std::string text;
  if (stl.compare(first, 5, word) != 0) {
    text = stl;
    std::ranges::transform(text, text.begin(), lower);
  }
  const std::string_view read = text.empty() ? stl : text, facet = "endfacet";
  const std::size_t last = read.rfind(facet), after = last == read.npos ? first : last + facet.size();
  if (read.find("end", after) == read.npos || read.find("outer loop", after) != read.npos)
    refuse(file, "cut: no line endsolid at its end");
  return text;
}

// assimp passes over what a glTF requires and it does not know: it reads quantized or packed numbers as others.
void require_plain_gltf(const fs::path& file, const std::string& bytes) {
  const std::size_t at = bytes.find("\"extensionsRequired\"");
  const std::string required = at == std::string::npos ? "" : bytes.substr(at, bytes.find(']', at) - at);
  for (const char* name : {"KHR_mesh_quantization", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"})
    if (required.find(name) != required.npos)
      refuse(file, "requires " + std::string(name) + ", which is not read; expected a mesh stored without it");
}

// assimp passes over a vertex that is indented, behind a byte order mark, has .5, a capital V or a colour with its
// alpha, and the faces' numbers then mean others. So it is given vertices as it reads them and faces of vertices alone,
// and nothing else. Refuses what is no vertex, with its line.
std::string with_every_vertex(const fs::path& file, std::string obj) {
  if (obj.starts_with("\xEF\xBB\xBF")) obj.erase(0, 3);
  for (std::size_t k = 1; k < obj.size(); ++k)
    if (obj[k - 1] == '\r' && obj[k] != '\n') obj[k - 1] = '\n';
  std::erase(obj, '\r');
  const auto is_number = [](const std::string& word) {
    double value = 0;
    const char* end = word.data() + word.size();
    return std::from_chars(word.data() + word.starts_with('+'), end, value).ptr == end;
  };
  std::istringstream text(std::move(obj));
  std::string out, line, more, first;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    for (; line.ends_with('\\') && std::getline(text, more); ++number) line.back() = ' ', line += more;
    std::istringstream words(line.substr(0, line.find('#')));
    first.clear();
    words >> first;
    const bool vertex = first == "v" || first == "V";
    if (!vertex && first != "f" && first != "F" && first != "fo") continue;
    std::vector<std::string> parts(std::istream_iterator<std::string>(words), {});
    const std::size_t count = parts.size();
    if (vertex && (count < 3 || count == 5 || count > 7 || !std::ranges::all_of(parts, is_number)))
      refuse(file, "line " + std::to_string(number) + ": '" + line.substr(0, 80) +
                       "'; expected v x y z, and a weight w or a colour r g b a");
    if (vertex && count != 4) parts.resize(3);
    out += vertex ? 'v' : 'f';
    for (std::string& part : parts) {
      if (const std::size_t dot = part.find('.'); vertex && dot == part.find_first_not_of("+-"))
        part.insert(dot, 1, '0');
      out += ' ' + part.substr(0, part.find('/'));
    }
    out += '\n';
  }
  return out;
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
  if (kind == ".ply") require_whole_ply(file, bytes);
  if (kind == ".dxf" && bytes.find("EOF", std::max<std::size_t>(bytes.size(), 100) - 100) == std::string::npos)
    refuse(file, "cut: no EOF at its end");
  if (kind == ".glb" || kind == ".gltf") require_plain_gltf(file, bytes);
  const std::string sound = kind == ".stl"   ? in_small_letters(file, bytes)
                            : kind == ".ply" ? with_first_byte_read(bytes)
                            : kind == ".obj" ? with_every_vertex(file, bytes)
                                             : std::string();
  const std::string& read = sound.empty() ? bytes : sound;
  Assimp::Importer importer;
  constexpr unsigned int steps = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure;
  // A glTF's buffers lie in files beside it, so that one is read from its place.
  const bool beside = kind == ".gltf" && !stored.packed();
  const aiScene* scene = beside ? importer.ReadFile(file.string(), steps)
                                : importer.ReadFileFromMemory(read.data(), read.size(), steps, kind.c_str() + 1);
  if (scene == nullptr || scene->mRootNode == nullptr) refuse(file, without_placeholder(importer.GetErrorString()));
  Mesh mesh;
  append(*scene, *scene->mRootNode, aiMatrix4x4t<double>(), unit, mesh);
  return mesh;
}

}  // namespace

double metres_per(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> units{
      {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};
  for (const auto& [name, metres] : units)
    if (name == unit) return metres;
  const std::vector<std::string> names = names_of(units, [](const auto& known) { return known.first; });
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
