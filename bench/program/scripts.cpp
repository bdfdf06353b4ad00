// Commands that start other commands and read what these wrote: scripts, which the program holds.
#include <unistd.h>

#include <zwang/bench/program/commands.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(campaign_script, ZWANG_CAMPAIGN)
ZWANG_EMBEDDED(job_template, ZWANG_JOB)
ZWANG_EMBEDDED(guard_script, ZWANG_GUARD)

namespace zwang {
namespace {

int continue_as_script(std::string_view script, std::vector<std::string> before,
                       const std::vector<std::string>& words) {
  before.insert(before.begin(), {"-c", std::string(script)});
  before.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
  before.insert(before.end(), words.begin(), words.end());
  return continue_as("python3", before);
}

}  // namespace

int campaign_command(std::vector<std::string> words) {
  return continue_as_script(campaign_script(), {std::string(job_template())}, words);
}

int guard_command(std::vector<std::string> words) { return continue_as_script(guard_script(), {}, words); }

}  // namespace zwang
