#include <zwang/bench/suite/phenomena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <zwang/bench/results/records.h>
#include <zwang/bench/results/result.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

// s of CPU time: of a solver on all phenomena, and of a solve. The problems have at most six unknowns.
constexpr SolveTime patience{.left = 1.5, .longest = 0.2};

}  // namespace

ConformanceSolve conformance_solve(const Run& run, Dispatcher& desk, SolveTime& time, Law* stated,
                                   const std::atomic<bool>* interrupted) {
  return conformance_solve(
      [&run, &desk, &time, interrupted](const Problem& problem) {
        Solution late;
        late.status = Status::time_limit;
        late.message = "stopped: its time was over";
        if (time.left <= 0) return late;
        desk.child.load(problem);
        const double limit = std::min(time.left, time.longest);
        SolveReply reply = desk.run(problem, run, {.time_limit = limit, .fresh = true}, interrupted);
        // One that the child had to stop has used up what it was given, whatever it says.
        time.left -= reply.solution.status == Status::time_limit ? std::max(reply.seconds, limit) : reply.seconds;
        return std::move(reply.solution);
      },
      stated);
}

void write_phenomena(const std::filesystem::path& directory, std::span<const Run> runs, Dispatcher& desk,
                     const std::atomic<bool>& interrupted) {
  const auto file = directory / "conformance.jsonl";
  std::filesystem::remove(file);
  std::vector<std::string> lines;
  for (const Run& run : runs) {
    Law law = stored_law;
    SolveTime time = patience;
    const ConformanceSolve solve = conformance_solve(run, desk, time, &law, &interrupted);
    for (const ConformanceCheck& check : conformance_checks()) {
      if (interrupted) return;
      const ConformanceResult result = check.run(solve);
      lines.push_back(to_json(Phenomenon{.solver = run.solver,
                                         .law = std::string(to_string(law)),
                                         .check = check.name,
                                         .expected = check.expected,
                                         .off = std::isfinite(result.off) ? result.off : unknown,
                                         .passes = result.passes(conformance_accepted),
                                         .applies = result.applies,
                                         .note = result.note}));
    }
  }
  ResultFile(file).append(lines);
}

}  // namespace zwang
