#include <zwang/bench/campaign/campaign.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include <zwang/bench/campaign/cell_list.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/stored_file.h>

namespace zwang {

NLOHMANN_JSON_SERIALIZE_ENUM(EngineKind, {{EngineKind::slurm, "slurm"},
                                          {EngineKind::parallel, "parallel"},
                                          {EngineKind::local, "local"}})

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// A script to be read, changed and run by hand.
std::string job_script(const Campaign& c) {
  std::string suite;
  for (const std::string& word : c.suite) suite.append(" ").append(quoted(word));
  const std::string here = quoted(c.directory.string()), program = quoted(c.program);
  const long minutes = std::max(1L, static_cast<long>(c.hours * 60 + 0.5));
  std::string text =
      "#!/bin/bash\n"
      "# One task of a campaign: ./job.sh K, K from 0 to " +
      std::to_string(c.tasks - 1) +
      ". Under Slurm K is the index in the array.\n"
      "# It goes on with what an earlier attempt left.\n"
      "#SBATCH --job-name=zwang\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task=1\n"
      "#SBATCH --time=" +
      std::to_string(minutes) +
      "\n"
      "#SBATCH --no-requeue\n"
      "#SBATCH --output=/dev/null\n";
  if (c.timing) text += "#SBATCH --exclusive\n";
  text += "dir=" + here + "\n" + "k=${1:-$SLURM_ARRAY_TASK_ID}\n" +
          "part=$dir/parts/$k\n"
          "mkdir -p \"$dir/parts\" \"$dir/logs\"\n"
          "exec >>\"$dir/logs/$k.log\" 2>&1\n"
          "echo \"$(date -u +%FT%TZ) $(hostname) task $k\"\n";
  if (c.timing)
    text +=
        "# Pinned to the first core that this task may use.\n"
        "pin=\"taskset -c $(taskset -cp $$ | sed 's/.*: //; s/[,-].*//')\"\n";
  const std::string run = std::string(c.timing ? "$pin " : "") + program + " bench";
  text +=
      "# Two attempts at one part at a time would repeat each other's work.\n"
      "exec 9>\"$dir/logs/$k.lock\"\n"
      "flock -n 9 || exit 0\n"
      "if [ -f \"$part/run.json\" ]; then\n"
      "  " +
      run +
      " --resume \"$part\" 9>&-\n"
      "else\n"
      "  [ ! -e \"$part\" ] || mv \"$part\" \"$part.before-$(date +%s)\"\n"
      "  " +
      run + suite + " --shard \"$k/" + std::to_string(c.tasks) +
      "\" --out \"$part\" 9>&-\n"
      "fi\n";
  return text;
}

void write_record(const Campaign& c) {
  Json started = Json::array();
  for (const Handle& h : c.started) started.push_back({{"id", h.id}, {"started", h.started}});
  const Json record = {{"program", c.program}, {"suite", c.suite},   {"engine", c.engine}, {"tasks", c.tasks},
                       {"at_once", c.at_once}, {"timing", c.timing}, {"hours", c.hours},   {"started", started}};
  replace_file(c.directory / "campaign.json", record.dump(2) + "\n");
}

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
    const Json j = Json::parse(in);
    Campaign c{.directory = fs::absolute(directory).lexically_normal(), .program = j.at("program")};
    if (!c.directory.has_filename()) c.directory = c.directory.parent_path();
    c.suite = j.at("suite").get<std::vector<std::string>>();
    c.engine = j.at("engine");
    c.tasks = j.at("tasks");
    c.at_once = j.at("at_once");
    c.timing = j.at("timing");
    c.hours = j.at("hours");
    for (const Json& h : j.at("started")) c.started.push_back({h.at("id"), h.at("started")});
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
