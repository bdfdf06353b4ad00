#!/bin/bash
# reversed_archive.sh OUT ARCHIVE...: one archive of the members of all, the last first.
set -eu
out=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
members=()
for archive in "$@"; do
  declare -A seen=()  # files compiled together may bear one name in several parts of an archive
  while read -r member; do
    seen[$member]=$((${seen[$member]:-0} + 1))
    place="$folder/$(basename "$archive")/${seen[$member]}"
    mkdir -p "$place"
    (cd "$place" && ar xN "${seen[$member]}" "$archive" "$member")
    members=("$place/$member" "${members[@]}")
  done < <(ar t "$archive")
  unset seen
done
rm -f "$out"
ar qc "$out" "${members[@]}"
ranlib "$out"
