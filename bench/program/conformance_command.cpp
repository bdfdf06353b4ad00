#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include <zwang/bench/conformance/conformance.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/suite/phenomena.h>
#include <zwang/bench/suite/plan.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

struct Marks {
  double tolerance = 1e-10, accepted = conformance_accepted;
  double time_limit = 2;  // s of CPU time, of a check
};

std::string verdict(const ConformanceResult& result, double accepted) {
  if (result.passes(accepted)) return "pass";
  if (!result.applies) return "not applicable";
  return std::isnan(result.off) ? "no answer" : "off by " + report::scientific(result.off);
}

// Every check on one solver: each(check, result). Returns the law that it reads.
template <class Each>
Law each_check(const std::string& solver, const Marks& marks, const Each& each) {
  const Run run{.solver = solver, .foreign = runs_apart(solver), .tolerance = marks.tolerance};
  Dispatcher desk;
  Law law = stored_law;
  SolveTime time;
  const ConformanceSolve solve = conformance_solve(run, desk, time, &law);
  for (const ConformanceCheck& check : conformance_checks()) {
    time = {.left = marks.time_limit};
    each(check, check.run(solve));
  }
  return law;
}

// How many checks do not pass.
int run_checks(const std::string& solver, const Marks& marks) {
  int failed = 0, all = 0;
  each_check(solver, marks, [&](const ConformanceCheck& check, const ConformanceResult& result) {
    std::printf("%-16s %-16s %s%s\n", check.name.c_str(), verdict(result, marks.accepted).c_str(),
                check.expected.c_str(), result.note.empty() ? "" : ("   (" + result.note + ")").c_str());
    std::fflush(stdout);
    failed += !result.passes(marks.accepted);
    ++all;
  });
  std::printf("\n%d of %d pass\n", all - failed, all);
  return failed;
}

// A line a solver, and what it is off by.
int map_of(const std::vector<std::string>& solvers, const Marks& marks) {
  Progress bar;
  const double checks = static_cast<double>(conformance_checks().size() * solvers.size());
  int failed = 0;
  double made = 0;
  for (const std::string& solver : solvers) {
    int passed = 0, applies = 0;
    std::string off;
    const Law law = each_check(solver, marks, [&](const ConformanceCheck& check, const ConformanceResult& result) {
      bar.show(++made / checks, solver + "   " + check.name);
      const bool passes = result.passes(marks.accepted);
      passed += passes;
      applies += result.applies;
      if (passes || !result.applies) return;
      const std::string by = std::isnan(result.off) ? "no answer" : report::scientific(result.off);
      off.append(off.empty() ? "; " : ", ").append(check.name).append(" ").append(by);
    });
    bar.clear();
    std::printf("%-19s %-12s %2d of %2d pass%s\n", solver.c_str(), std::string(to_string(law)).c_str(), passed, applies,
                off.c_str());
    std::fflush(stdout);
    failed += applies - passed;
  }
  return failed;
}

}  // namespace

int conformance_command(std::vector<std::string> words) {
  CLI::App options(
      "Runs solvers on phenomena of friction whose discrete-time answers are known exactly, and says what they are "
      "off by. A solver that does not read Coulomb's law gets the problems under the law that it reads: convex, "
      "pyramid or frictionless.");
  introduce(options, "conformance",
            "  ./zwang conformance --solver cone\n"
            "  ./zwang conformance --solver newton --tolerance 1e-8\n"
            "  ./zwang conformance --solver cone,nsgs,newton\n"
            "  ./zwang conformance\n"
            "Exit code 1 where a check does not pass.\n"
            "Of physics engines instead of solvers: ./zwang conformance --engines --help");
  std::string names;
  Marks marks;
  options.add_option("--solvers,--solver", names,
                     "NAME or NAME:key=value,...; several: a,b, a line each; default: all");
  within(tolerances, options.add_option("--tolerance", marks.tolerance, "asked of the solver; default: 1e-10"));
  within(above(0), options.add_option("--accept", marks.accepted, "how far an answer may be off; default: 1e-6"));
  within(above(0, "s"), options.add_option("--time-limit", marks.time_limit, "CPU time of each check; default: 2"));
  if (!read(options, std::move(words))) return done;
  const std::vector<std::string> chosen =
      names.empty() ? names_of(solvers(), &SolverEntry::name) : split_solvers(names);
  for (const std::string& solver : chosen) make_solver(solver);
  const int failed = chosen.size() == 1 ? run_checks(chosen[0], marks) : map_of(chosen, marks);
  return failed == 0 ? done : found;
}

}  // namespace zwang
