#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/packs/answers.h>
#include <zwang/bench/suite/suite.h>

namespace zwang {

// Judges answers as a suite judges solvers, problem by problem, into settings.directory: results.jsonl, run.json and
// the pack's problems. A problem without an answer is unsolved. Contestants of one name are told apart by their file's
// name.
Outcome judge_pack(const Pack& pack, std::vector<Answers> contestants, SuiteSettings settings,
                   const std::atomic<bool>& interrupted);

// Solves the pack's problems one by one and appends their answers to `file`. Throws std::invalid_argument where there
// is no such solver.
struct PackRun {
  std::string solver = {};
  double tolerance = 1e-10;
  double time_limit = 10;  // s of CPU time a problem
};
std::size_t solve_pack(const Pack& pack, const PackRun& run, const std::filesystem::path& file,
                       const PackProgress& progress, const std::atomic<bool>& interrupted);

}  // namespace zwang
