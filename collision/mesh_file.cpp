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
  if (type.ends_with("char") || type.ends_with("int8")) return 1;
  if (type.ends_with("short") || type.ends_with("int16")) return 2;
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

// An element of a PLY file.
struct PlyElement {
  std::string name = {}, lines = {};  // lines of the header
  std::size_t count = 0, bytes = 0;   // of a binary one; lists are longer
  std::vector<bool> lists = {};       // which of its properties
};

// As assimp reads it; "": as it is. assimp crashes where another element stands before the vertices, as the cameras of
// some programs do: it is left out. It takes a first byte of binary data that is the end of a line, such as 0x0A in the
// float -0.02, for part of the header: each vertex gets another byte before it. Of text that ends early it would make a
// part of the mesh, and of triangle strips one triangle each.
std::string from_vertices_on(const fs::path& file, const std::string& ply) {
  const std::size_t end = ply.find("end_header");
  if (end == std::string::npos) refuse(file, "cut within its header; expected a line end_header");
  std::istringstream header(ply.substr(0, end));
  std::vector<PlyElement> elements(1);  // the first: what stands before them
  for (std::string line; std::getline(header, line); elements.back().lines += line + '\n') {
    std::istringstream words(line);
    std::string word, name;
    words >> word >> name;
    if (word == "element") words >> elements.emplace_back(PlyElement{name}).count;
    if (word == "element" && name == "tristrips" && elements.back().count > 0)
      refuse(file, "its triangles are strips; expected an element face");
    if (word == "property")
      elements.back().lists.push_back(name == "list"), elements.back().bytes += bytes_of_ply(name);
  }
  const bool text = elements[0].lines.find("format ascii") != std::string::npos;
  std::size_t data = ply.find('\n', end) + 1, wanted = 0, seen = 0;
  bool changed = false;
  for (; elements.size() > 1 && elements[1].name != "vertex" && elements[1].name != "face"; changed = true) {
    const PlyElement other = elements[1];
    elements.erase(elements.begin() + 1);
    if (!text && std::ranges::count(other.lists, true) > 0)
      refuse(file, "its element " + other.name + ", which has lists, stands before its vertices");
    for (std::size_t k = text ? other.count : 0; k > 0 && data > 0; --k) data = ply.find('\n', data) + 1;
    data += text ? 0 : std::min(ply.size(), other.count) * other.bytes;
  }
  if (data == 0 || data > ply.size()) refuse(file, "cut before its data");
  std::vector<bool> lists;  // of the last element
  for (const PlyElement& element : elements)
    if (element.count > 0) wanted += element.count, lists = element.lists;
  std::istringstream records(text ? ply.substr(data) : "");
  std::string last;
  for (std::string line; std::getline(records, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) ++seen, last = line;
  if (text && (seen < wanted || (seen == wanted && words_missing(last, lists) > 0)))
    refuse(file, "cut: " + grouped(seen) + " lines of data; expected " + grouped(wanted) + " whole ones");
  PlyElement& first = elements[elements.size() > 1];
  const bool marked = !text && (ply[data] == '\n' || ply[data] == '\r') && std::ranges::count(first.lists, true) == 0 &&
                      first.bytes > 0 && first.count <= (ply.size() - data) / first.bytes;
  if (!changed && !marked) return {};
  if (marked) first.lines.insert(first.lines.find('\n') + 1, "property uchar first\n");
  std::string out;
  for (const PlyElement& element : elements) out += element.lines;
  out += "end_header\n";
  for (std::size_t k = 0; marked && k < first.count; ++k, data += first.bytes)
    out.append(1, 'x').append(ply, data, first.bytes);
  return out.append(ply, data);
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

// assimp passes over what a glTF requires and it does not know: it reads quantized or packed numbers as others. And it
// turns by quaternions as they are: one of another length would shear and swell the mesh. Three digits are near enough.
void require_plain_gltf(const fs::path& file, const std::string& bytes) {
  const std::size_t at = bytes.find("\"extensionsRequired\"");
  const std::string required = at == std::string::npos ? "" : bytes.substr(at, bytes.find(']', at) - at);
  for (const char* name : {"KHR_mesh_quantization", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"})
    if (required.find(name) != required.npos)
      refuse(file, "requires " + std::string(name) + ", which is not read; expected a mesh stored without it");
  for (std::size_t k = 0; (k = bytes.find("\"rotation\"", k)) != bytes.npos; ++k) {
    Eigen::Vector4d q;
    const std::string node = bytes.substr(k, 400);
    if (std::sscanf(node.c_str(), "\"rotation\" : [ %lf , %lf , %lf , %lf", &q[0], &q[1], &q[2], &q[3]) == 4 &&
        !(std::abs(q.norm() - 1) <= 1e-3))
      refuse(file, printed("a rotation by a quaternion of length %g; expected length 1", q.norm()));
  }
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
  if (kind == ".dxf" && bytes.find("EOF", std::max<std::size_t>(bytes.size(), 100) - 100) == std::string::npos)
    refuse(file, "cut: no EOF at its end");
  if (kind == ".glb" || kind == ".gltf") require_plain_gltf(file, bytes);
  const std::string sound = kind == ".stl"   ? in_small_letters(file, bytes)
                            : kind == ".ply" ? from_vertices_on(file, bytes)
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
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  const double far = std::max(box.max().maxCoeff(), -box.min().minCoeff()), size = box.sizes().norm();
  if (size > 0 && 0x1p-24 * far > 1e-4 * size)  // assimp reads single precision
    refuse(file,
           printed("%g m across, %g m from the origin: single precision spoils it; expected it nearer", size, far));
  return mesh;
}

}  // namespace

double metres_per(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 6> units{
      {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};
  for (const auto& [name, metres] : units)
    if (name == unit) return metres;
  throw std::invalid_argument("no unit '" + std::string(unit) + "' (m, cm, mm, um, in, ft)");
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
