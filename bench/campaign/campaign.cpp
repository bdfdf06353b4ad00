#include <zwang/bench/campaign/campaign.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include <zwang/bench/campaign/cell_list.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/stored_file.h>

ZWANG_EMBEDDED(job_template, ZWANG_JOB)

namespace zwang {

NLOHMANN_JSON_SERIALIZE_ENUM(EngineKind, {{EngineKind::slurm, "slurm"},
                                          {EngineKind::parallel, "parallel"},
                                          {EngineKind::local, "local"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Handle, id, started)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Campaign, program, suite, engine, tasks, at_once, timing, hours, started)

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

// A script to be read, changed and run by hand.
std::string job_script(const Campaign& c) {
  std::string suite, text(job_template());
  for (const std::string& word : c.suite) suite.append(" ").append(quoted(word));
  const long minutes = std::max(1L, static_cast<long>(c.hours * 60 + 0.5));
  const std::pair<std::string, std::string> words[] = {
      {"@tasks@", std::to_string(c.tasks)},
      {"@last@", std::to_string(c.tasks - 1)},
      {"@minutes@", std::to_string(minutes)},
      // Alone on a node, and pinned to a core there; or neither.
      {"@exclusive@", c.timing ? "#SBATCH --exclusive" : "#"},
      {"@core@", c.timing ? "$(taskset -cp $$ | sed 's/.*: //; s/[,-].*//')" : ""},
      {"@dir@", quoted(c.directory.string())},
      {"@program@", quoted(c.program)},
      {"@suite@", suite}};
  for (const auto& [word, value] : words)
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += value.size())
      text.replace(at, word.size(), value);
  return text;
}

void write_record(const Campaign& c) { replace_file(c.directory / "campaign.json", Json(c).dump(2) + "\n"); }

bool has_run(const fs::path& part) { return fs::exists(part / "run.json"); }

// Lines of growing files, each byte read once.
class LineCounter {
 public:
  std::size_t count(const fs::path& file) {
    auto& [read, lines] = seen_[file.string()];
    std::error_code none;
    const std::uintmax_t size = fs::file_size(file, none);
    if (none) return lines;
    if (size < read) read = lines = 0;  // begun anew
    if (size == read) return lines;
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(read));
    char part[1 << 16];
    while (in.read(part, sizeof part) || in.gcount() > 0) {
      lines += static_cast<std::size_t>(std::count(part, part + in.gcount(), '\n'));
      read += static_cast<std::uintmax_t>(in.gcount());
    }
    return lines;
  }

 private:
  std::map<std::string, std::pair<std::uintmax_t, std::size_t>> seen_;
};

}  // namespace

void write_campaign(const Campaign& campaign) {
  fs::create_directories(campaign.directory / "parts");
  fs::create_directories(campaign.directory / "logs");
  const fs::path job = campaign.directory / "job.sh";
  replace_file(job, job_script(campaign));
  fs::permissions(job, fs::perms::owner_exec | fs::perms::group_exec, fs::perm_options::add);
  write_record(campaign);
}

Campaign read_campaign(const fs::path& directory) {
  const fs::path file = directory / "campaign.json";
  std::ifstream in(file);
  if (!in) throw BadFile(directory.string() + " holds no campaign: campaign.json is missing");
  try {
    Campaign c = Json::parse(in);
    c.directory = fs::absolute(directory).lexically_normal();
    if (!c.directory.has_filename()) c.directory = c.directory.parent_path();
    return c;
  } catch (const Json::exception& wrong) {
    throw BadFile(file.string() + ": " + one_line(wrong.what()));
  }
}

std::vector<std::size_t> unfinished_tasks(const Campaign& campaign) {
  std::vector<std::size_t> tasks;
  for (std::size_t k = 0; k < campaign.tasks; ++k) {
    const fs::path part = campaign.part(k);
    bool whole = false;
    if (has_run(part)) {
      const CellList cells(part);
      const std::vector<bool> there = cells_there(cells, {part});
      whole = true;
      for (std::size_t i = 0; i < there.size() && whole; ++i) whole = there[i] || !cells.holds(i);
    }
    if (!whole) tasks.push_back(k);
  }
  return tasks;
}

CampaignEnd follow(Campaign& campaign, const std::atomic<bool>& interrupted, bool terminal) {
  LineCounter counter;
  Progress progress(terminal);
  std::size_t planned = 0;
  const auto lines = [&] {
    std::size_t n = 0;
    for (std::size_t k = 0; k < campaign.tasks; ++k) {
      n += counter.count(campaign.part(k) / "results.jsonl");
      if (planned == 0 && has_run(campaign.part(k))) planned = CellList(campaign.part(k)).size();
    }
    return n;
  };
  const auto active = [&] { return !campaign.started.empty() && is_active(campaign.engine, campaign.started.back()); };
  constexpr int most_idle_rounds = 2;  // in a row, without a new line
  for (int idle = 0; !interrupted;) {
    const std::size_t before = lines();
    if (!active()) {
      const std::vector<std::size_t> tasks = unfinished_tasks(campaign);
      if (tasks.empty()) return CampaignEnd::complete;
      if (idle == most_idle_rounds) return CampaignEnd::stuck;
      campaign.started.push_back(start_tasks(campaign.engine, campaign.directory, tasks, campaign.at_once));
      write_record(campaign);
    }
    const double start = wall_seconds();
    while (!interrupted && active()) {
      const std::size_t now = lines();
      const double fraction = planned > 0 ? static_cast<double>(now) / static_cast<double>(planned) : 0;
      const double left = now > before
                              ? (wall_seconds() - start) * static_cast<double>(planned - std::min(planned, now)) /
                                    static_cast<double>(now - before)
                              : -1;
      progress.show(fraction, grouped(now) + " of " + grouped(planned) + " runs", left);
      // A scheduler is asked less often than a process.
      const int tenths = campaign.engine == EngineKind::slurm ? 20 : 3;
      for (int i = 0; i < tenths && !interrupted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    idle = lines() > before ? 0 : idle + 1;
  }
  return CampaignEnd::interrupted;
}

}  // namespace zwang
