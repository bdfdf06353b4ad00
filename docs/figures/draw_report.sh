#!/bin/sh -e
# draw_report.sh PROGRAM: docs/report.png, the picture in README.md, and docs/sample-report.html, which stays below 1 MB. Two
# minutes, on a machine with nothing else to do. Needs rsvg-convert.
docs=$(cd "$(dirname "$0")/.." && pwd)
runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT
"$1" bench --scenes 'hand(contacts=16,seed=1..5)' --out "$runs/five" \
  --solvers dual_active_set,newton,apgd,ipopt,nnls_paper,mujoco_newton
"$1" report "$runs/five" --figures svg --chart work-precision
rsvg-convert -w 1280 -o "$docs/report.png" "$runs/five/figures/work-precision-hand.svg"
"$1" bench --scenes 'hand(contacts=4,16,64)' --solvers dual_active_set,newton,nnls_paper,apgd --tolerances 1e-3,1e-6,1e-9 \
  --out "$runs/sample"
cp "$runs/sample/report.html" "$docs/sample-report.html"
