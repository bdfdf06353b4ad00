# Checks that the native solvers decide by solvers/linalg/tolerances.h alone, and the referee and the references by
# core/referee/tolerances.h: no literal of the kind 1e-9 or 0x1p-40 elsewhere. What decides nothing is listed; the
# certificate in 100 digits, which shares nothing, has its own. Run: cmake -DSOURCE_DIR=... -P literals.cmake
cmake_minimum_required(VERSION 3.25)

# Settings, whose default is their documentation; values that another library asks for; the example of a
# guide; budgets of time and storage; ranges of exponents; formats of scalars.
set(no_decision
  "double refactor_above = 1e-8" "double rank_threshold = 1e-12"
  "long_tile = 1e5" "operations_per_second = 2e9" "bytes / 1e9"
  "smallest = 0x1p-300, largest = 0x1p300"
  "fine = 0x1p-63" "split = 0x1p27" "never_asked_for = 0x1p28"
  "unbounded = 2e19" "half \\* half, 1e-22" "left\\(\\), 1e-" "default_gain = 1e-8" "ray = 1e-6" "least_gap = 1e-14"
  "least_tolerance = 1e-14" "unlimited = 1e10" "unbounded = 1e20" "least_seconds = 1e-6" "stiffness = 1e4" "ask = 1e-3" "go up to 1e4"
  "distance_to_go\\(1e-15")

set(files)
foreach(folder solvers core/referee bench/references)
  file(GLOB_RECURSE found RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp)
  list(APPEND files ${found})
endforeach()
list(FILTER files EXCLUDE REGEX "^solvers/(registry|solver_entry)|/tolerances.h$|/kkt_certificate.h$")
list(LENGTH files count)
if(count LESS 90)
  message(SEND_ERROR "only ${count} files found in ${SOURCE_DIR}")
endif()
foreach(file ${files})
  file(STRINGS ${SOURCE_DIR}/${file} lines REGEX "[^a-zA-Z_0-9.]([0-9.]+e-?[0-9]+|0x1p-?[0-9]+)")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "//.*" "" code "${line}")
    if(NOT code MATCHES "[^a-zA-Z_0-9.]([0-9.]+e-?[0-9]+|0x1p-?[0-9]+)")
      continue()
    endif()
    set(decides TRUE)
    foreach(known ${no_decision})
      if(code MATCHES "${known}")
        set(decides FALSE)
      endif()
    endforeach()
    if(decides)
      message(SEND_ERROR "${file}: '${code}': a tolerance belongs in solvers/linalg/tolerances.h, or the referee's, with its reason")
    endif()
  endforeach()
endforeach()
