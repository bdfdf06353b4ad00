#pragma once

#include <cstdlib>
#include <filesystem>

#include "tests/folders.h"

namespace zwang::test {

// As zwang::recorded_data (bench/scenes/recorded_data.h), for tests that link no scenes.
inline std::filesystem::path recorded_data() {
  const char* given = std::getenv("ZWANG_DATA");
  return given && *given ? std::filesystem::path(given) : source_dir() / "../shared/data";
}

}  // namespace zwang::test
