#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/campaign/engine.h>

namespace zwang {

// A suite in tasks: DIR/job.sh runs one of them, DIR/parts/K is its result, DIR/campaign.json what is asked and what
// was started. docs/campaigns.md.
struct Campaign {
  std::filesystem::path directory = {};  // absolute
  std::string program = {};              // absolute: what the tasks run
  std::vector<std::string> suite = {};   // words of ./zwang bench that say what is run
  EngineKind engine = EngineKind::local;
  std::size_t tasks = 1, at_once = 1;
  bool timing = false;  // cores of their own, pinned
  double hours = 4;     // a task's limit, for Slurm
  std::vector<Handle> started = {};

  std::filesystem::path part(std::size_t task) const { return directory / "parts" / std::to_string(task); }
};

// Writes job.sh and campaign.json of a new campaign. Throws BadFile.
void write_campaign(const Campaign& campaign);
Campaign read_campaign(const std::filesystem::path& directory);  // throws BadFile

// Tasks whose part lacks a run, or that left none.
std::vector<std::size_t> unfinished_tasks(const Campaign& campaign);

enum class CampaignEnd { complete, interrupted, stuck };

// Starts what is unfinished, follows it, starts again what is missing when all have ended: until nothing is missing,
// or a round brought nothing. On interruption the tasks go on.
CampaignEnd follow(Campaign& campaign, const std::atomic<bool>& interrupted, bool terminal);

}  // namespace zwang
