# Run at every build: writes OUTPUT with a hash over BUILT_WITH (compiler, flags, libraries) and the sources that
# references depend on, when it changed. These are
# the files of bench/references, what they include of the project, directly or not, and the .cpp files of the same names.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/included_sources.cmake)
file(GLOB own RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/bench/references/*.h ${SOURCE_DIR}/bench/references/*.cpp
  ${SOURCE_DIR}/bench/references/friction/*.h ${SOURCE_DIR}/bench/references/friction/*.cpp)
included_sources(found ${own})
list(SORT found)
set(hashes "${BUILT_WITH}\n")
foreach(file ${found})
  file(SHA256 ${SOURCE_DIR}/${file} hash)
  string(APPEND hashes "${file} ${hash}\n")
endforeach()
string(SHA256 hash "${hashes}")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include <zwang/bench/references/cache.h>

namespace zwang {
const std::string_view reference_sources = "@hash@";
}  // namespace zwang
]] @ONLY)
