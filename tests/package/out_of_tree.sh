#!/usr/bin/env bash
# out_of_tree.sh SOURCE BUILD|sources WORK: docs/examples/out-of-tree against the install tree of BUILD, or against the
# sources by add_subdirectory: configured, built without -march, run. Its solver and its scene stand in the report.
set -euo pipefail
source=$1 build=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
cp -r "$source/docs/examples/out-of-tree" "$work/project"

if [ "$build" = sources ]; then
  flags=(-DZWANG_SOURCE="$source")
else
  cmake --install "$build" --prefix "$work/prefix" >"$work/install.log"
  flags=(-DCMAKE_PREFIX_PATH="$work/prefix")
  # What is installed names neither the sources nor the build.
  if grep -rIl -e "$source/" -e "$build/" "$work/prefix"; then
    echo "the installed files above name the source tree" >&2
    exit 1
  fi
fi
cmake -S "$work/project" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release "${flags[@]}" >"$work/configure.log"
cmake --build "$work/build" --target beads check >"$work/build.log" || { tail -n 30 "$work/build.log" >&2; exit 1; }

# As its user runs it: from elsewhere; where the right to do so is there, with nothing to be seen in the source tree.
beads=$work/build/beads
run() { (cd "$work" && env -u ZWANG_DATA "$@"); }
if [ "$build" != sources ] && unshare --mount true 2>/dev/null; then
  cp -r "$work" /tmp/zwang-out-of-tree.$$
  trap 'rm -rf /tmp/zwang-out-of-tree.'$$ EXIT
  work=/tmp/zwang-out-of-tree.$$ beads=$work/build/beads
  run() { (cd "$work" && unshare --mount bash -c 'mount -t tmpfs none "$0" && cd "$PWD" && exec env -u ZWANG_DATA "$@"' "$source" "$@"); }
fi
run "$work/build/check" >"$work/check.log" && [ "$(grep -c ' ok$' "$work/check.log")" -eq 9 ] || { cat "$work/check.log" >&2; exit 1; }
! run "$work/build/check" wrong >"$work/wrong.log"
grep -q 'on_wire.jacobian: analytic vs central differences, bodies 1 m apart: at row 1, body b, angular y it gives' "$work/wrong.log" ||
  { cat "$work/wrong.log" >&2; exit 1; }
run "$beads" scenes | grep beads >/dev/null  # not -q, which leaves before all is written
run "$beads" solvers | grep delassus_sweeps >/dev/null
run "$beads" bench --scenes 'beads(beads=2,5,10)' --solvers delassus_sweeps,dual_active_set --tolerances 1e-8 --out "$work/run" >"$work/bench.log" 2>&1 ||
  { cat "$work/bench.log" >&2; exit 1; }
[ "$(grep -c '"verified":"solved"' "$work/run/results.jsonl")" -eq 6 ] || { cat "$work/run/results.jsonl" >&2; exit 1; }
grep -q delassus_sweeps "$work/run/report.html"
grep -q 'beads(' "$work/run/report.html"
run "$beads" fuzz --count 200 --solvers delassus_sweeps >"$work/fuzz.log" 2>&1 || [ $? -eq 1 ]
