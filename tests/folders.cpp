#include "tests/folders.h"

#include <unistd.h>

#include <set>

// The HDF5 library loses memory of its own when it gives up on a damaged file, Siconos where it solves.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\nleak:libsiconos"; }

namespace zwang {

std::filesystem::path source_dir() { return ZWANG_SOURCE_DIR; }

std::filesystem::path own_path(const std::string& name) {
  struct Given : std::set<std::filesystem::path> {
    ~Given() {
      for (const auto& path : *this) std::filesystem::remove_all(path);
    }
  };
  static Given given;
  return *given.insert(std::filesystem::temp_directory_path() / ("zwang-" + std::to_string(getpid()) + "-" + name))
              .first;
}

}  // namespace zwang
