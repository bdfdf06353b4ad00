// Commands that start other commands and read what these wrote: scripts, which the program holds.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <iterator>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/report/page/draw.h>
#include <zwang/bench/report/page/page.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/process/child_process.h>

ZWANG_EMBEDDED(campaign_script, ZWANG_CAMPAIGN)
ZWANG_EMBEDDED(job_template, ZWANG_JOB)
ZWANG_EMBEDDED(merge_script, ZWANG_MERGE)
ZWANG_EMBEDDED(league_script, ZWANG_LEAGUE)
ZWANG_EMBEDDED(guard_script, ZWANG_GUARD)
ZWANG_EMBEDDED(junit_script, ZWANG_JUNIT)
ZWANG_EMBEDDED(gradients_script, ZWANG_GRADIENTS)
ZWANG_EMBEDDED(held_script, ZWANG_HELD)
ZWANG_EMBEDDED(results_script, ZWANG_RESULTS)
ZWANG_EMBEDDED(aggregation_script, ZWANG_AGGREGATION)
ZWANG_EMBEDDED(tables_script, ZWANG_TABLES)
ZWANG_EMBEDDED(charts_script, ZWANG_CHARTS)
ZWANG_EMBEDDED(report_script, ZWANG_REPORT)
ZWANG_EMBEDDED(tables_json, ZWANG_TABLES_JSON)
ZWANG_EMBEDDED(stability_json, ZWANG_STABILITY_JSON)

namespace zwang {
namespace {

std::string from_stdin() { return {std::istreambuf_iterator<char>(std::cin), {}}; }

}  // namespace

int continue_as_files(const std::vector<std::pair<std::string, std::string_view>>& files,
                      const std::vector<std::string>& words, const std::vector<std::string>& before) {
  std::vector<std::string> all = {"-c", std::string(held_script()), std::to_string(files.size())};
  for (const auto& [name, text] : files) all.insert(all.end(), {name, std::string(text)});
  all.insert(all.end(), before.begin(), before.end());
  all.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
  all.insert(all.end(), words.begin(), words.end());
  std::fflush(stdout);
  return continue_as("python3", all);
}

// `:page KIND`: that page, of the data in stdin. `:draw DATA FIGURES TABLES`: charts and tables for print.
int report_command(std::vector<std::string> words) {
  if (words.size() == 2 && words[0] == ":page") {
    std::cout << report::page(words[1], from_stdin());
    return done;
  }
  if (words.size() == 4 && words[0] == ":draw") return report::draw_figures(words[1], words[2], words[3]), done;
  return continue_as_files({{"stability.json", stability_json()},
                            {"tables.json", tables_json()},
                            {"results.py", results_script()},
                            {"aggregation.py", aggregation_script()},
                            {"tables.py", tables_script()},
                            {"charts.py", charts_script()},
                            {"report.py", report_script()}},
                           words);
}

int write_report(const std::vector<std::string>& words, bool silent) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) return bad_file;
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (silent && !std::freopen("/dev/null", "w", stderr)) _exit(bad_file);
    try {
      report_command(words);
    } catch (const std::exception& broken) {
      std::fprintf(stderr, "No report: %s\n", broken.what());
    }
    _exit(bad_file);
  }
  const int status = wait_for_child(child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : bad_file;
}

int campaign_command(std::vector<std::string> words) {
  return continue_as_files({{"campaign.py", campaign_script()}}, words, {std::string(job_template())});
}

// `:sound`: of each pair of lines, a file and a hash, whether it is that problem.
int merge_command(std::vector<std::string> words) {
  if (words != std::vector<std::string>{":sound"}) return continue_as_files({{"merge.py", merge_script()}}, words);
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

int league_command(std::vector<std::string> words) {
  return continue_as_files({{"results.py", results_script()}, {"league.py", league_script()}}, words);
}

int guard_command(std::vector<std::string> words) { return continue_as_files({{"guard.py", guard_script()}}, words); }

int compare_gradients(const std::vector<std::string>& words) {
  return continue_as_files({{"gradients.py", gradients_script()}}, words);
}

int write_junit(const std::filesystem::path& results, const std::string& file, int code) {
  return continue_as_files({{"junit.py", junit_script()}}, {results.string(), file, std::to_string(code)});
}

}  // namespace zwang
