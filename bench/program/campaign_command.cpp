#include <zwang/bench/program/commands.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(campaign_script, ZWANG_CAMPAIGN)
ZWANG_EMBEDDED(job_template, ZWANG_JOB)

namespace zwang {

int campaign_command(std::vector<std::string> words) {
  words.insert(words.begin(), {"-c", std::string(campaign_script()), std::string(job_template()),
                               std::filesystem::read_symlink("/proc/self/exe").string()});
  return continue_as("/usr/bin/python3", words);
}

}  // namespace zwang
