#!/usr/bin/env bash
# Each header compiles by itself. Usage: headers_alone.sh SOURCE_DIR COMPILER EIGEN_INCLUDE INCLUDE
# Of a header that its own .cpp includes first, the build has shown it.
set -euo pipefail
cd "$1"
check() {
  source=${3%.h}.cpp
  [ -f "$source" ] && [ "$(grep -m1 '^#include' "$source")" = "#include <zwang/$3>" ] && return
  echo "#include <zwang/$3>" | "$1" -std=c++20 -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=0 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I"$4" -isystem "$2" -x c++ - ||
    { echo "$3 does not compile alone"; exit 1; }
}
export -f check
find core constraints solvers collision bench experiments -name node_modules -prune -o -name '*.h' -print0 |
  xargs -0 -P 2 -I{} bash -c 'check "$@"' _ "$2" "$3" {} "$4"
