#pragma once

#include <cstdlib>
#include <filesystem>

namespace zwang::test {

// As zwang::recorded_data (bench/scenes/recorded_data.h), for tests that link no scenes.
inline std::filesystem::path recorded_data() {
  const char* given = std::getenv("ZWANG_DATA");
  return given && *given ? given : ZWANG_SOURCE_DIR "/../shared/data";
}

}  // namespace zwang::test
