#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace zwang {

// What the commands that run for long have in common.

// From now on the first Ctrl-C sets this, so that a run ends cleanly; a second one ends the program at once.
const std::atomic<bool>& stop_on_interrupt();

// What was typed, for a shell: "./zwang NAME WORDS...".
std::string command_line(const std::string& name, const std::vector<std::string>& words);

// The folder of a new run: `out`, or when that is empty results/20261120-2354, or with -2, -3, ... where that is taken.
// Throws std::invalid_argument when it holds a run; `resume`: the command that would go on with it, up to the folder.
std::filesystem::path new_directory(const std::string& out, const std::string& resume);

}  // namespace zwang
