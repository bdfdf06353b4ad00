#include <zwang/collision/load.h>

#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

// A glTF's buffers lie in other files, which its own bytes do not name the contents of.
bool is_whole(const fs::path& file) { return file.extension() != ".gltf" && file.extension() != ".GLTF"; }

fs::path place_of(const StoredFile& file, const MeshFileOptions& options) {
  if (options.cache.empty() || !is_whole(file.path)) return {};
  char how[64];
  std::snprintf(how, sizeof how, "-%016llx-%016llx", std::bit_cast<unsigned long long>(options.unit),
                std::bit_cast<unsigned long long>(options.weld));
  return options.cache / (file.sha256 + how + ".tree");
}

bool read_cached(const fs::path& place, LoadedTree& out) {
  std::ifstream in(place, std::ios::binary | std::ios::ate);
  if (!in) return false;
  std::string bytes(static_cast<std::size_t>(in.tellg()), '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())) || bytes.size() < sizeof(MeshReport))
    return false;
  try {
    out.tree = Tree::from_bytes(std::string_view(bytes).substr(sizeof(MeshReport)));
  } catch (const std::runtime_error&) {
    return false;  // torn: built anew, and written over
  }
  std::memcpy(static_cast<void*>(&out.report), bytes.data(), sizeof(MeshReport));
  return out.cached = true;
}

// Under its name only when complete. A cache that cannot be written is done without.
void write_cached(const fs::path& place, const LoadedTree& loaded) {
  std::error_code ignored;
  fs::create_directories(place.parent_path(), ignored);
  const fs::path beside = place.string() + "." + std::to_string(::getpid());
  std::ofstream out(beside, std::ios::binary);
  const std::string bytes = loaded.tree.to_bytes();
  out.write(reinterpret_cast<const char*>(&loaded.report), sizeof(MeshReport));
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out)
    fs::rename(beside, place, ignored);
  else
    fs::remove(beside, ignored);
}

}  // namespace

LoadedTree load_tree(const fs::path& file, const MeshFileOptions& options) {
  const StoredFile stored = read_stored(file);
  const fs::path place = place_of(stored, options);
  LoadedTree out;
  if (place.empty() || !read_cached(place, out)) {
    MeshFile read = read_mesh(stored, options);
    if (options.progress) options.progress(0.75, "building the tree");
    out.report = read.report;
    out.tree = Tree(read.mesh);
    if (!place.empty()) write_cached(place, out);
  }
  if (options.progress) options.progress(1, "ready");
  return out;
}

fs::path tree_cache() {
  const fs::path place = fs::path("zwang") / "trees";
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return cache / place;
  if (const char* home = std::getenv("HOME"); home && *home) return home / (".cache" / place);
  return {};
}

}  // namespace zwang::collision
