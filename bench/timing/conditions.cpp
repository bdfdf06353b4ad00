#include <zwang/bench/timing/conditions.h>

#include <sched.h>
#include <fstream>

#include <zwang/core/problem/wording.h>
#include "built_from.h"

namespace zwang {
namespace {

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

int usable_cores() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

}  // namespace

Conditions conditions() {
  Conditions c;
  c.version = ZWANG_VERSION;
  c.commit = ZWANG_COMMIT;
  c.dirty = ZWANG_DIRTY;
  c.compiler = ZWANG_COMPILER;
  c.flags = ZWANG_FLAGS;
  c.build_type = ZWANG_BUILD_TYPE;
#ifdef NDEBUG
  c.debug = false;
#else
  c.debug = true;
#endif
  c.cpu = cpu_name();
  c.cores = usable_cores();
  for (const std::string& part : split(ZWANG_LIBRARIES)) {
    const auto blank = part.find(' ');
    c.libraries[part.substr(0, blank)] = part.substr(blank + 1);
  }
  return c;
}

}  // namespace zwang
