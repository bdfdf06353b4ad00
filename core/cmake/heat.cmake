# zwang_heat(hot|cold|test TARGET...): how hard the compiler works on TARGET. Hot is what an answer waits for (-O3); cold
# is what reads, writes, asks and draws (-O1, half the time to compile), and so are tests.
# Each level has one precompiled header of the standard library and Eigen, and of the project's own what of Eigen is
# compiled once. JSON is not in it: its literal parses, so that every file would instantiate the parser. g++ takes the
# level from that header, not from the command line, and refuses it where a flag differs: one set of flags for all files
# of a level, libraries and programs alike. A file with flags of its own goes without (SKIP_PRECOMPILE_HEADERS).
# zwang_unity(N TARGET...): N files of a folder are compiled as one, which instantiates what they share once: a third less of
# a first build. More, and a change in one is waited for. It comes after SKIP_UNITY_BUILD_INCLUSION of files long enough.
option(ZWANG_PRECOMPILED "precompile the headers of others" ON)

function(zwang_heat LEVEL)
  foreach(target ${ARGN})
    zwang_level(${LEVEL} ${target})
    if(ZWANG_PRECOMPILED)
      target_precompile_headers(${target} REUSE_FROM zwang_${LEVEL}_headers)
    endif()
  endforeach()
endfunction()

function(zwang_unity N)
  foreach(target ${ARGN})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${target} SOURCES)
    set(last -)
    foreach(source ${sources})
      get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
      if(alone OR NOT source MATCHES "\\.cpp$")
        continue()
      endif()
      get_filename_component(folder ${source} DIRECTORY)
      if(NOT "${folder}" STREQUAL "${last}")
        set(last "${folder}")
        set(count 0)
      endif()
      math(EXPR group "${count} / ${N}")
      math(EXPR count "${count} + 1")
      get_filename_component(name "${folder}" NAME)
      if(NOT IS_ABSOLUTE ${source})  # a test, which may be compiled with the sources it is about
        string(PREPEND name test_)
      endif()
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}_${group})
    endforeach()
  endforeach()
endfunction()

function(zwang_level LEVEL TARGET)
  set_target_properties(${TARGET} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${TARGET} PRIVATE -fPIC)
  if(NOT LEVEL STREQUAL "hot")
    target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(LEVEL STREQUAL "test")  # GoogleTest's macros name the file: not by its whole path, for clones share a cache
    target_compile_options(${TARGET} PRIVATE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
  endif()
endfunction()

# zwang_precompile(LEVEL HEADER...): the precompiled header of LEVEL, of what all levels have and HEADERs.
function(zwang_precompile LEVEL)
  if(NOT ZWANG_PRECOMPILED)
    return()
  endif()
  set(source ${PROJECT_BINARY_DIR}/${LEVEL}_headers.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Headers are precompiled as part of a library, and a library has a source.\n")
  add_library(zwang_${LEVEL}_headers OBJECT ${source})
  target_link_libraries(zwang_${LEVEL}_headers PRIVATE zwang_options)
  zwang_level(${LEVEL} zwang_${LEVEL}_headers)
  target_precompile_headers(zwang_${LEVEL}_headers PRIVATE
    <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <cstdint> <cstdio> <cstdlib> <cstring> <filesystem>
    <fstream> <functional> <limits> <map> <memory> <numbers> <numeric> <optional> <set> <span> <sstream> <stdexcept>
    <string> <string_view> <thread> <tuple> <type_traits> <utility> <variant> <vector>
    <Eigen/Core> <Eigen/Cholesky> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <Eigen/QR> <Eigen/SparseCholesky>
    <Eigen/SparseCore> <zwang/core/problem/eigen_once.h> ${ARGN})
endfunction()
