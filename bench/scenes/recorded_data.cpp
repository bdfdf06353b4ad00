#include <zwang/bench/scenes/recorded_data.h>

#include <cstdlib>

namespace zwang {

std::filesystem::path recorded_data() {
  const char* given = std::getenv("ZWANG_DATA");
  return given && *given ? given : "$ZWANG_DATA";
}

}  // namespace zwang
