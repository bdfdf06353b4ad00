#pragma once

#include <cstdlib>
#include <filesystem>

namespace zwang {

// Where problems, parts and recordings lie that are no part of the project: in the folder of the
// environment variable ZWANG_DATA, which ./zwang sets to ../shared/data. May be absent; messages then show the
// variable.
inline std::filesystem::path recorded_data() {
  const char* given = std::getenv("ZWANG_DATA");
  return given && *given ? given : "$ZWANG_DATA";
}

}  // namespace zwang
