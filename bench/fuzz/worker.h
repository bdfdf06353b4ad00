#pragma once

#include <atomic>
#include <filesystem>

#include <zwang/bench/fuzz/fuzz.h>

namespace zwang {

// One finding and the file that replays it.
struct Finding {
  std::uint64_t number;
  std::string solver, what;
  std::string file = {};  // "" where none could be written, as `what` says then, and beyond the first 20 of a solver
};

struct FuzzOutcome {
  std::vector<std::string> solvers = {};
  std::vector<FuzzTally> tally = {};
  std::vector<Finding> findings = {};  // by problem and solver, whichever worker came first
  std::uint64_t done = 0;
  double seconds = 0;  // wall clock
  bool interrupted = false;
};

// Fuzzes in `jobs` processes of their own. A worker that dies, or stays at one problem for a minute, is a finding (the
// problem and the solver at which it happened), and another one goes on behind that problem. Findings are written to
// `directory`, which is made when the first comes. `progress`: problems done so far. Where interrupted, workers end
// what they are at, or a second later.
FuzzOutcome run_fuzz(const FuzzOptions& options, int jobs, const std::filesystem::path& directory,
                     std::span<const SolverEntry> among, const std::function<void(std::uint64_t)>& progress,
                     const std::atomic<bool>& interrupted);

}  // namespace zwang
