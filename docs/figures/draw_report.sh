#!/bin/sh -e
# draw_report.sh PROGRAM: docs/report.png, the picture in README.md, and docs/sample-report.html, which stays below 1 MB. Half a
# minute, on a machine with nothing else to do. Needs rsvg-convert.
docs=$(cd "$(dirname "$0")/.." && pwd)
program=$(realpath "$1")
runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT
cd "$runs"
"$program" bench --scenes 'hand(contacts=16,seed=1..5)' --solvers dual_active_set,newton,apgd,ipopt,nnls_paper,mujoco_newton --out five
"$program" report five --figures svg --chart work-precision
rsvg-convert -w 1280 -o "$docs/report.png" five/figures/work-precision-hand.svg
"$program" bench --scenes 'hand(contacts=4,16,64)' --solvers dual_active_set,apgd,nnls_paper --tolerances 1e-3,1e-6,1e-9 --out sample
cp sample/report.html "$docs/sample-report.html"
