#include <zwang/collision/load.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <zwang/core/problem/wording.h>
#include <zwang/core/process/isolated.h>

namespace zwang::collision {
namespace {

namespace fs = std::filesystem;

// A glTF's buffers lie in other files, which its own bytes do not name the contents of.
bool is_whole(const fs::path& file) { return file.extension() != ".gltf" && file.extension() != ".GLTF"; }

fs::path place_of(const StoredFile& file, const MeshFileOptions& options) {
  if (options.cache.empty() || !is_whole(file.path)) return {};
  return options.cache /
         (sha256(file.bytes) + printed("-%016llx-%016llx%s%s.tree2", std::bit_cast<unsigned long long>(options.unit),
                                       std::bit_cast<unsigned long long>(options.weld), file.kind().c_str(),
                                       file.packed() ? ".gz" : ""));
}

// Far more than a sound file needs: the slowest format takes a second for 10 MB, the most wasteful 30 bytes a byte.
IsolationLimits limits_of(const StoredFile& file) {
  const double bytes = static_cast<double>(file.bytes.size()) * (file.packed() ? 8 : 1);
  return {.seconds = 5 + bytes / 1e6, .bytes = (std::size_t{1} << 30) + static_cast<std::size_t>(80 * bytes)};
}

// A tree as the cache holds it and as the child process writes it: the report, then the tree.
std::string build(const StoredFile& file, const MeshFileOptions& options) {
  return isolated(file.path, limits_of(file), [&] {
    const MeshFile read = read_mesh(file, options);
    return std::string(reinterpret_cast<const char*>(&read.report), sizeof(MeshReport)) + Tree(read.mesh).to_bytes();
  });
}

// Throws std::runtime_error unless it is a whole one.
void take(std::string_view bytes, LoadedTree& out) {
  out.tree = Tree::from_bytes(bytes.substr(std::min(bytes.size(), sizeof(MeshReport))));
  std::memcpy(static_cast<void*>(&out.report), bytes.data(), sizeof(MeshReport));
}

bool read_cached(const fs::path& place, LoadedTree& out) {
  try {
    take(read_stored(place).bytes, out);
  } catch (const std::runtime_error&) {
    return false;  // absent, or torn: built anew, and written over
  }
  return out.cached = true;
}

// A cache that cannot be written is done without.
void write_cached(const fs::path& place, std::string_view bytes) {
  std::error_code ignored;
  fs::create_directories(place.parent_path(), ignored);
  try {
    replace_file(place, bytes);
  } catch (const BadFile&) {
  }
}

}  // namespace

LoadedTree load_tree(const fs::path& file, const MeshFileOptions& options) {
  const StoredFile stored = read_stored(file);
  const fs::path place = place_of(stored, options);
  LoadedTree out;
  if (place.empty() || !read_cached(place, out)) {
    if (options.progress) options.progress(0, "reading");
    const std::string built = build(stored, options);
    take(built, out);
    if (!place.empty()) write_cached(place, built);
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
