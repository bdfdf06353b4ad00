#!/bin/bash
# reversed_archive.sh OUT ARCHIVE...: one archive of the members of all, the last first.
set -eu
out=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
members=()
for archive in "$@"; do
  mkdir "$folder/$(basename "$archive")"
  (cd "$folder/$(basename "$archive")" && ar x "$archive")
  while read -r member; do members=("$folder/$(basename "$archive")/$member" "${members[@]}"); done < <(ar t "$archive")
done
rm -f "$out"
ar qc "$out" "${members[@]}"
ranlib "$out"
