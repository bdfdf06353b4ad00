#include <zwang/bench/suite/phenomena.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include <zwang/bench/conformance/conformance.h>
#include <zwang/bench/results/result.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

// s of CPU time a solve, and of a solver on all phenomena: the problems have at most six unknowns.
constexpr double time_limit = 0.2, patience = 1.5;

std::string line_of(const Run& run, Law law, const ConformanceCheck& check, const ConformanceResult& result) {
  return nlohmann::ordered_json{
      {"solver", run.solver},
      {"law", to_string(law)},
      {"check", check.name},
      {"expected", check.expected},
      {"off", std::isfinite(result.off) ? nlohmann::ordered_json(result.off) : nlohmann::ordered_json(nullptr)},
      {"passes", result.passes(conformance_accepted)},
      {"applies", result.applies},
      {"note", result.note}}
      .dump();
}

}  // namespace

void write_phenomena(const std::filesystem::path& directory, std::span<const Run> runs, Dispatcher& desk,
                     const std::atomic<bool>& interrupted) {
  std::map<std::string, Run> tightest;
  std::vector<std::string> order;
  for (const Run& run : runs) {
    if (!tightest.contains(run.solver)) order.push_back(run.solver);
    tightest[run.solver] = run;  // tolerances go from loose to tight
  }
  const auto file = directory / "conformance.jsonl";
  std::filesystem::remove(file);
  std::vector<std::string> lines;
  for (const std::string& solver : order) {
    const Run& run = tightest[solver];
    Law law = Law::coulomb;
    double spent = 0;
    const ConformanceSolve solve = conformance_solve(
        [&](const Problem& problem) {
          Solution late;
          late.status = Status::time_limit;
          late.message = "stopped: its time for all phenomena was over";
          if (spent > patience) return late;
          desk.child.load(problem);
          SolveReply reply = desk.run(problem, run, {.time_limit = time_limit, .fresh = true}, &interrupted);
          spent += reply.seconds;
          return std::move(reply.solution);
        },
        &law);
    for (const ConformanceCheck& check : conformance_checks()) {
      if (interrupted) return;
      const ConformanceResult result = check.run(solve);
      lines.push_back(line_of(run, law, check, result));
    }
  }
  ResultFile(file).append(lines);
}

}  // namespace zwang
