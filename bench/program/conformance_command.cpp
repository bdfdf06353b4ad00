#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include <zwang/bench/conformance/conformance.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/solvers/registry.h>

namespace zwang {

int conformance_command(std::vector<std::string> words) {
  CLI::App options(
      "Runs a solver on phenomena of friction whose discrete-time answers are known exactly, and says what it is off\n"
      "by. A solver that does not read Coulomb's law gets the problems under the law that it reads: convex, pyramid "
      "or\n"
      "frictionless.");
  introduce(options, "conformance",
            "  ./zwang conformance --solver cone\n"
            "  ./zwang conformance --solver newton --tolerance 1e-8\n"
            "Exit code 1 where a check does not pass.");
  std::string name;
  double tolerance = 1e-10, accepted = 1e-6;
  options.add_option("--solver", name, "NAME or NAME:key=value,...")->required();
  options.add_option("--tolerance", tolerance, "asked of the solver; default: 1e-10")->check(above(0));
  options.add_option("--accept", accepted, "how far an answer may be off; default: 1e-6")->check(above(0));
  if (!read(options, std::move(words))) return done;
  const ConformanceSolve solve = conformance_solve(make_solver(name), tolerance);
  int passed = 0, all = 0;
  for (const ConformanceCheck& check : conformance_checks()) {
    const ConformanceResult result = check.run(solve);
    const bool passes = result.passes(accepted);
    const std::string verdict = passes                   ? "pass"
                                : std::isnan(result.off) ? "no answer"
                                                         : "off by " + report::scientific(result.off);
    std::printf("%-16s %-16s %s%s\n", check.name.c_str(), verdict.c_str(), check.expected.c_str(),
                result.note.empty() ? "" : ("   (" + result.note + ")").c_str());
    passed += passes;
    ++all;
  }
  std::printf("\n%d of %d pass\n", passed, all);
  return passed == all ? done : found;
}

}  // namespace zwang
