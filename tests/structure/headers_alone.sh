#!/usr/bin/env bash
# Each header compiles by itself. Usage: headers_alone.sh SOURCE_DIR COMPILER EIGEN_INCLUDE
set -euo pipefail
cd "$1"
check() {
  echo "#include \"$3\"" | "$1" -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I. -isystem "$2" -x c++ - ||
    { echo "$3 does not compile alone"; exit 1; }
}
export -f check
find core constraints solvers collision bench experiments -name node_modules -prune -o -name '*.h' -print0 |
  xargs -0 -P 2 -I{} bash -c 'check "$@"' _ "$2" "$3" {}
