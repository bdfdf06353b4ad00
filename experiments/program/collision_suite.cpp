#include <unistd.h>
#include <cstdio>

#include <zwang/bench/collision/suite.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/report/report.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/experiments/god_hand/run/collision_scenes.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {

int bench_collision(const std::filesystem::path& directory, const std::string& command) {
  bool whole = false;
  const std::vector<std::string> lines =
      run_collision_suite({.directory = directory,
                           .hands = god::collision_scenes(recorded_data()),
                           .command = command,
                           .terminal = isatty(STDERR_FILENO) == 1},
                          stop_on_interrupt(), whole);
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  if (!whole) std::printf("Stopped. What was finished is in %s\n", (directory / "collision.json").c_str());
  std::printf("Report: %s\n", report::write_report(directory).c_str());
  return whole ? done : stopped;
}

}  // namespace zwang
