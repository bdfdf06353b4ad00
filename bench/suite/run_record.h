#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <zwang/bench/suite/plan.h>

namespace zwang {

// DIR/run.json: under which conditions a run was made, and what it takes to go on with it (docs/formats.md).
struct RunRecord {
  std::string command = {};
  std::string started = {}, finished = {};  // ISO 8601, UTC; finished is "" until the run is complete
  std::vector<std::string> notes = {};
};

void write_run_record(const std::filesystem::path& directory, const Plan& plan, std::span<const SolverEntry> among,
                      const RunRecord& record);
RunRecord read_run_record(const std::filesystem::path& directory);

// The options of the run in this folder. Throws std::invalid_argument when an option typed now (`is_given` knows those
// by their names) differs from the stored one; BadFile when the folder holds no run, or one of another commit,
// compiler, build or CPU.
SuiteOptions options_to_resume(const std::filesystem::path& directory, const SuiteOptions& typed,
                               const std::function<bool(const std::string& name)>& is_given);

// Throws BadFile when the plan's problems are not the ones that the run in this folder began with.
void require_same_problems(const std::filesystem::path& directory, const Plan& plan);

}  // namespace zwang
