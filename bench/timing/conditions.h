#pragma once

#include <map>
#include <string>

namespace zwang {

// Under which conditions this program was built and runs: what a reader needs to judge or repeat its times.
struct Conditions {
  std::string version;   // of zwang
  std::string commit;    // of the sources, at the build; "unknown" outside a repository
  bool dirty;            // the sources had uncommitted changes
  std::string compiler;  // "GNU 12.2.0"
  std::string flags;
  std::string build_type;                        // "Release"
  bool debug;                                    // assertions are on: times mean nothing
  std::string cpu;                               // as /proc/cpuinfo names it
  int cores;                                     // that this process may use
  std::map<std::string, std::string> libraries;  // name -> version, at the build
};

Conditions conditions();

}  // namespace zwang
