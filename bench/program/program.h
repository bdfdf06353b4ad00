#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/registry.h>

namespace zwang {

// Exit codes of the program: 0 done, 1 fuzzing found a fault or runs are missing, 2 wrong use, 3 a file that cannot be
// used, 130 stopped with Ctrl-C.
enum Exit : int { done = 0, found = 1, wrong_use = 2, bad_file = 3, stopped = 130 };

// One word of the command line. `words`: what follows it. Throws std::invalid_argument (wrong use) or BadFile, whose
// one line the program prints. Group and line are for --help; those of commands.def stand there.
struct Command {
  using Run = int(std::vector<std::string> words);
  std::string name;
  std::function<Run> run;
  std::string group = {};
  std::string line = {};
};

// Runs the suite `collision` and returns the exit code. `command`: the command line, for the record.
using CollisionSuite = int (*)(const std::filesystem::path& directory, const std::string& command);

// What a host adds to the program: solvers and scenes stand beside ours in every command, suite, chart and table.
struct Extensions {
  std::vector<SolverEntry> solvers = {};
  std::vector<SceneEntry> scenes = {};
  std::vector<Command> commands = {};
  CollisionSuite collision = nullptr;
};

// The whole program: reads the command line, runs one command, returns its exit code.
int program(int count, char** arguments, const Extensions& extensions = {});

}  // namespace zwang
