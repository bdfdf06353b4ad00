#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace zwang {

// Exit codes of the program: 0 done, 1 fuzzing found a fault, 2 wrong use, 3 a file that cannot be used, 130 stopped
// with Ctrl-C.
enum Exit : int { done = 0, found = 1, wrong_use = 2, bad_file = 3, stopped = 130 };

// One word of the command line. `words`: what follows it. Throws std::invalid_argument (wrong use) or BadFile, whose
// one line main() prints.
struct Command {
  std::string name;
  std::string group;
  std::string line;  // for --help
  int (*run)(std::vector<std::string> words);
};

int bench_command(std::vector<std::string> words);
int solve_command(std::vector<std::string> words);
int solvers_command(std::vector<std::string> words);
int scenes_command(std::vector<std::string> words);
int export_command(std::vector<std::string> words);
int report_command(std::vector<std::string> words);
int fuzz_command(std::vector<std::string> words);
int mesh_command(std::vector<std::string> words);
int simulate_command(std::vector<std::string> words);
int hand_command(std::vector<std::string> words);
int experiment_command(std::vector<std::string> words);

// Where real parts and recordings lie, which are not the project's: $ZWANG_DATA, or ../shared/data beside the project.
std::filesystem::path real_data();

// `bench --suite collision`.
int bench_collision(const std::filesystem::path& directory, const std::string& command,
                    const std::atomic<bool>& interrupted);

}  // namespace zwang
