// Commands that start other commands and read what these wrote: scripts, which the program holds.
#include <iostream>
#include <iterator>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/report/page/page.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/problem_file.h>

ZWANG_EMBEDDED(campaign_script, ZWANG_CAMPAIGN)
ZWANG_EMBEDDED(job_template, ZWANG_JOB)
ZWANG_EMBEDDED(merge_script, ZWANG_MERGE)
ZWANG_EMBEDDED(league_script, ZWANG_LEAGUE)
ZWANG_EMBEDDED(guard_script, ZWANG_GUARD)
ZWANG_EMBEDDED(junit_script, ZWANG_JUNIT)

namespace zwang {

int continue_as_script(std::string_view script, std::vector<std::string> before,
                       const std::vector<std::string>& words) {
  before.insert(before.begin(), {"-c", std::string(script)});
  before.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
  before.insert(before.end(), words.begin(), words.end());
  std::fflush(stdout);
  return continue_as("python3", before);
}

int campaign_command(std::vector<std::string> words) {
  return continue_as_script(campaign_script(), {std::string(job_template())}, words);
}

// `:sound`: of each pair of lines, a file and a hash, whether it is that problem.
int merge_command(std::vector<std::string> words) {
  if (words != std::vector<std::string>{":sound"}) return continue_as_script(merge_script(), {}, words);
  for (std::string file, sha256; std::getline(std::cin, file) && std::getline(std::cin, sha256);) {
    bool sound = false;
    try {
      const std::vector<Instance> read = read_problems(file);
      sound = read.size() == 1 && problem_sha256(read.front().problem) == sha256;
    } catch (const BadFile&) {
    }
    std::cout << (sound ? "sound" : "damaged") << std::endl;
  }
  return done;
}

// `:page`: the page of the data in stdin.
int league_command(std::vector<std::string> words) {
  if (words != std::vector<std::string>{":page"}) return continue_as_script(league_script(), {}, words);
  std::cout << report::league_page({std::istreambuf_iterator<char>(std::cin), {}});
  return done;
}

int guard_command(std::vector<std::string> words) { return continue_as_script(guard_script(), {}, words); }

int write_junit(const std::filesystem::path& results, const std::string& file, int code) {
  return continue_as_script(junit_script(), {}, {results.string(), file, std::to_string(code)});
}

}  // namespace zwang
