# Run at every build: writes OUTPUT with a hash over the sources that references depend on, when it changed. These are
# the files of bench/references, what they include of the project, directly or not, and the .cpp files of the same names.
cmake_minimum_required(VERSION 3.25)
file(GLOB open RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/bench/references/*.h ${SOURCE_DIR}/bench/references/*.cpp)
set(found)
while(open)
  list(POP_FRONT open file)
  if(file IN_LIST found OR NOT EXISTS ${SOURCE_DIR}/${file})
    continue()
  endif()
  list(APPEND found ${file})
  string(REGEX REPLACE "\\.h$" ".cpp" same_name ${file})
  list(APPEND open ${same_name})
  file(STRINGS ${SOURCE_DIR}/${file} lines REGEX "^#include <zwang/")
  foreach(line ${lines})
    string(REGEX REPLACE "#include <zwang/([^>]*)>.*" "\\1" header ${line})
    list(APPEND open ${header})
  endforeach()
endwhile()
list(SORT found)
set(hashes)
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
