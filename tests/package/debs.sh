#!/usr/bin/env bash
# debs.sh SOURCE WORK [BUILD]: cpack's three packages, built for any machine (or as BUILD is), each installed in a bare root of Debian 12 and used
# there: the program runs its quick suite, Python imports the module, a project finds the library. 77: skipped.
set -euo pipefail
source=$1 work=$2 build=${3:-}
skip() { echo "skipped: $1"; exit 77; }
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed"
[ "$(id -u)" -eq 0 ] || skip "a bare root needs root's rights"

mkdir -p "$work"
if [ -z "$build" ]; then
  build=$work/build
  cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DZWANG_TESTS=OFF -DZWANG_NATIVE=OFF >"$work/configure.log"
  cmake --build "$build" >"$work/build.log" || { tail -n 30 "$work/build.log" >&2; exit 1; }
fi
rm -rf "$work/packages"
cpack --config "$build/CPackConfig.cmake" -B "$work/packages" >"$work/cpack.log" 2>&1 || { tail -n 30 "$work/cpack.log" >&2; exit 1; }

base=$work/base.tar
[ -e "$base" ] || mmdebstrap --quiet --mode=root --variant=minbase bookworm "$base" || skip "no mirror of Debian 12 is reached"
root=$work/root
leave() { umount "$root/proc" "$root/dev" 2>/dev/null || true; }
trap leave EXIT
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
# new_root PACKAGE...: a bare root with our packages and what they depend on.
new_root() {
  leave
  rm -rf "$root"
  mkdir "$root"
  tar -C "$root" -xf "$base"
  cp -r /etc/apt/. "$root/etc/apt/"
  cp -L /etc/resolv.conf "$root/etc/" 2>/dev/null || true
  mount -t proc none "$root/proc"
  mount --bind /dev "$root/dev"
  cp "$work"/packages/*.deb "$root/root/"
  inside apt-get -qq update
  local files=()
  for package in "$@"; do files+=("$(cd "$root" && ls "root/${package}"_*.deb | sed 's|^|/|')"); done
  inside apt-get -qq install -y --no-install-recommends "${files[@]}" >"$work/install.log" 2>&1 ||
    { tail -n 30 "$work/install.log" >&2; exit 1; }
  for package in "$@"; do [ -s "$root/usr/share/doc/$package/copyright" ]; done
}

new_root zwang
inside sh -c 'cd /root && zwang bench --suite quick --out quick' >"$work/quick.log" 2>&1 || { tail -n 30 "$work/quick.log" >&2; exit 1; }
[ -s "$root/root/quick/report.html" ]
grep -q '"solver":"ipopt".*"verified":"solved"' "$root/root/quick/results.jsonl"

new_root python3-zwang
inside python3 -c '
import numpy as np, zwang
p = zwang.Problem(M=np.eye(1), z_u=[-1.0], J=np.eye(1), c=[0.0])
s = zwang.solve(p, "dual_active_set")
assert "solved" in str(zwang.judge(p, s.z)), zwang.judge(p, s.z)' || exit 1

new_root libzwang-dev
inside apt-get -qq install -y --no-install-recommends g++ make >>"$work/install.log" 2>&1
mkdir "$root/root/project"
cat >"$root/root/project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(uses_zwang CXX C)
find_package(zwang 0.2 REQUIRED COMPONENTS core)
add_executable(size size.cpp)
target_link_libraries(size zwang::core)
END
cat >"$root/root/project/size.cpp" <<'END'
#include <zwang/core/files/problem_file.h>
#include <cstdio>
int main() {
  zwang::Instance one;
  one.problem.name = "free";
  one.problem.z_u = zwang::Vector::Ones(1);
  one.problem.M.resize(1, 1);
  one.problem.M.insert(0, 0) = 2;
  one.problem.J.resize(0, 1);
  zwang::write_problem("one.h5", one);
  std::printf("%d unknowns\n", static_cast<int>(zwang::read_problems("one.h5").at(0).problem.size()));
}
END
inside sh -c 'cd /root/project && cmake -S . -B build && cmake --build build && build/size' >"$work/project.log" 2>&1 || { tail -n 30 "$work/project.log" >&2; exit 1; }
grep -qx '1 unknowns' "$work/project.log"
echo "three packages install and run in a bare root"
