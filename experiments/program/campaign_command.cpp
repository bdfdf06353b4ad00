#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include <zwang/bench/campaign/campaign.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

namespace fs = std::filesystem;

// The result is replaced in one step; that of an earlier attempt goes.
int finish(const Campaign& campaign, const std::string& command) {
  std::vector<fs::path> parts;
  for (std::size_t k = 0; k < campaign.tasks; ++k)
    if (fs::exists(campaign.part(k) / "run.json")) parts.push_back(campaign.part(k));
  if (parts.empty()) throw BadFile("no task of " + campaign.directory.string() + " left a run: see its logs/");
  const fs::path result = campaign.directory / "result";
  fs::remove_all(result);
  return merge_and_report(parts, result, command);
}

int run_campaign(Campaign& campaign, const std::string& command) {
  const std::string dir = report::shell_word(campaign.directory.string());
  switch (follow(campaign, stop_on_interrupt(), isatty(STDERR_FILENO) == 1)) {
    case CampaignEnd::interrupted:
      std::printf("The tasks go on. Come back with: ./zwang campaign --resume %s   (to end them: %s)\n", dir.c_str(),
                  campaign.started.empty() ? "none" : how_to_stop(campaign.engine, campaign.started.back()).c_str());
      return stopped;
    case CampaignEnd::stuck:
      std::printf(
          "%zu of %zu tasks are not finished and made no progress: see %s/logs, then ./zwang campaign --resume %s\n",
          unfinished_tasks(campaign).size(), campaign.tasks, dir.c_str(), dir.c_str());
      finish(campaign, command);
      return bad_file;
    case CampaignEnd::complete:
      break;
  }
  return finish(campaign, command);
}

}  // namespace

int campaign_command(std::vector<std::string> words) {
  CLI::App options("Runs a suite in tasks on a cluster or on this machine, joins their results, writes the report.");
  introduce(options, "campaign",
            "  ./zwang campaign big --engine slurm --tasks 64 --out big\n"
            "  ./zwang campaign quick --engine parallel --tasks 8 --out runs --solvers nnls,pgs\n"
            "  ./zwang campaign --resume big\n"
            "The first word names a suite (./zwang bench --help); without one it is standard.\n"
            "What is run is said as for ./zwang bench: --scenes, --problems, --solvers, --tolerances, --accuracy, ...");
  options.allow_extras(true);
  std::string suite, engine = "local", out, resume;
  Campaign campaign;
  campaign.at_once = std::max(1u, std::thread::hardware_concurrency());
  options.add_option("--engine", engine, "slurm, parallel (GNU parallel) or local (the default)");
  within(from_to(1, 100000), options.add_option("--tasks", campaign.tasks, "parts that the problems are dealt out to"));
  within(from(1), options.add_option("--at-once", campaign.at_once,
                                     "tasks that run at a time; default: the cores of this machine"));
  within(above(0, "h"), options.add_option("--hours", campaign.hours, "a task's time limit under Slurm; default: 4"));
  options.add_flag("--timing", campaign.timing, "each task alone on its node (Slurm --exclusive), pinned to a core");
  options.add_option("--out", out, "folder of the campaign")->type_name("DIR");
  options.add_option("--resume", resume, "come back to a campaign: follow it, start what is missing")->type_name("DIR");
  const std::string command = command_line("campaign", words);
  // After options of bench, which are passed on unread, their values would be taken for the suite.
  if (!words.empty() && !words.front().starts_with('-')) {
    suite = words.front();
    words.erase(words.begin());
  }
  if (!read(options, std::move(words))) return done;
  if (!resume.empty()) {
    if (!suite.empty() || !options.remaining().empty() || !out.empty())
      throw std::invalid_argument("--resume DIR takes what is run from DIR");
    campaign = read_campaign(resume);
    return run_campaign(campaign, command);
  }
  if (out.empty()) throw std::invalid_argument("a campaign needs a folder: --out DIR");
  campaign.engine = engine_kind(engine);
  campaign.directory = fs::absolute(out).lexically_normal();
  if (!campaign.directory.has_filename()) campaign.directory = campaign.directory.parent_path();
  if (fs::exists(campaign.directory / "campaign.json"))
    throw std::invalid_argument(out + " holds a campaign already: come back with ./zwang campaign --resume " +
                                report::shell_word(out));
  if (campaign.timing && campaign.engine != EngineKind::slurm) campaign.at_once = 1;
  campaign.program = fs::read_symlink("/proc/self/exe").string();
  campaign.suite = {"--suite", suite.empty() ? "standard" : suite};
  std::ranges::move(options.remaining(), std::back_inserter(campaign.suite));
  require_suite(campaign.suite);
  require_engine(campaign.engine);
  write_campaign(campaign);
  std::printf("%zu tasks, %zu at a time: %s\n", campaign.tasks, campaign.at_once,
              (campaign.directory / "job.sh").c_str());
  std::fflush(stdout);
  return run_campaign(campaign, command);
}

}  // namespace zwang
