#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace zwang {

// What starts the tasks of a campaign: Slurm, GNU parallel, or processes of this machine (xargs). Whatever it starts
// goes on when this program ends.
enum class EngineKind { slurm, parallel, local };
EngineKind engine_kind(const std::string& name);  // throws std::invalid_argument

// Tasks that were handed over. What is needed to ask for them later, as text in campaign.json.
struct Handle {
  std::string id = {};       // Slurm: of the job; else: of the process
  std::string started = {};  // of the process: tells it from a later one of the same id
};

// Throws std::runtime_error where the engine is not on this machine.
void require_engine(EngineKind engine);

// Runs DIR/job.sh K for every K of tasks, at most at_once of them at a time. Throws std::runtime_error with the
// engine's own words.
Handle start_tasks(EngineKind engine, const std::filesystem::path& directory, const std::vector<std::size_t>& tasks,
                   std::size_t at_once);

// Whether any of them still waits or runs. True also where a scheduler does not answer.
bool is_active(EngineKind engine, const Handle& handle);

// "scancel 17", "kill 4711": the command that ends them.
std::string how_to_stop(EngineKind engine, const Handle& handle);

}  // namespace zwang
