#include <CLI/CLI.hpp>
#include <cstdio>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/registry.h>

namespace zwang {

int solvers_command(std::vector<std::string> words) {
  CLI::App options(
      "The solvers: name, method, what it cannot do, the laws it reads friction under, settings. Without such laws it "
      "solves problems that are frictionless or have pyramids.");
  introduce(options, "solvers",
            "  ./zwang solvers\n  ./zwang bench --solvers nnls,pgs:KEY=VALUE     a setting follows a colon");
  if (!read(options, std::move(words))) return done;
  for (const SolverEntry& e : solvers()) {
    std::printf("%-18s %s%s\n", e.name.c_str(), e.method.c_str(), e.foreign ? " (in a process of its own)" : "");
    if (!e.limits.empty()) std::printf("%-18s limits: %s\n", "", e.limits.c_str());
    if (!e.laws.empty()) {
      std::vector<std::string> laws;
      for (const Law law : e.laws) laws.emplace_back(to_string(law));
      std::printf("%-18s laws of friction: %s\n", "", joined(laws).c_str());
    }
    for (const SettingInfo& s : e.settings)
      std::printf("%-18s   %s=%s   %s\n", "", s.name.c_str(), s.value.c_str(), s.help.c_str());
  }
  for (const AbsentSolver& s : absent_solvers())
    std::printf("%-18s not built in: %s\n", std::string(s.name).c_str(), std::string(s.how_to_add).c_str());
  return done;
}

}  // namespace zwang
