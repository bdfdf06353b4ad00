#include <CLI/CLI.hpp>
#include <cstdio>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

// The classes of problems it reads: QP, where it takes a problem without friction, and the laws under which it reads
// cones of friction.
std::string read_by(const SolverEntry& e) {
  const std::string laws = words_of(e.laws, ", ");
  return laws.empty() ? "QP" : e.make("").supports(Problem()).empty() ? "QP, " + laws : laws;
}

void print_whole(const SolverEntry& e) {
  std::printf("%-18s %s%s\n", e.name.c_str(), e.method.c_str(), e.foreign ? " (in a process of its own)" : "");
  std::printf("%-18s reads %s%s\n", "", read_by(e).c_str(), e.exact ? "; exact" : "");
  if (!e.limits.empty()) std::printf("%-18s limits: %s\n", "", e.limits.c_str());
  for (const SettingInfo& s : e.settings)
    std::printf("%-18s   %s=%s   %s\n", "", s.name.c_str(), s.value.c_str(), s.help.c_str());
}

void print_group(const char* title, bool foreign) {
  std::printf("%s\n", title);
  for (const SolverEntry& e : solvers())
    if (e.foreign == foreign)
      std::printf("  %-20s %-5s  %-20s  %s\n", e.name.c_str(), e.exact ? "exact" : "", read_by(e).c_str(),
                  e.method.c_str());
}

}  // namespace

int solvers_command(std::vector<std::string> words) {
  CLI::App options(
      "The solvers, what each reads, and its method; with names: what each cannot do, and its settings. QP: problems "
      "without friction, or with pyramids. Exact: the answer does not depend on the tolerance.");
  introduce(options, "solvers",
            "  ./zwang solvers\n  ./zwang solvers cone pgs\n"
            "  ./zwang bench --solvers nnls,pgs:KEY=VALUE     a setting follows a colon");
  std::vector<std::string> names;
  options.add_option("NAME", names, "solvers to show whole")->type_name("");
  if (!read(options, std::move(words))) return done;
  for (const std::string& name : names) {
    make_solver(name);  // throws where there is none
    print_whole(*find_solver(name));
  }
  if (!names.empty()) return done;
  print_group("Of zwang", false);
  print_group("\nOf others, each in a process of its own", true);
  std::puts("\nNot built in");
  for (const AbsentSolver& s : absent_solvers())
    std::printf("  %-20s not built in: %s\n", std::string(s.name).c_str(), std::string(s.how_to_add).c_str());
  std::puts("\n./zwang solvers NAME says what it cannot do, and its settings.");
  return done;
}

}  // namespace zwang
