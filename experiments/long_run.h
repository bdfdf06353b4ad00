#pragma once

#include <atomic>
#include <filesystem>

namespace zwang {

// What the commands that run for long have in common.

// From now on the first Ctrl-C sets this, so that a run ends cleanly; a second one ends the program at once.
const std::atomic<bool>& stop_on_interrupt();

// results/20261120-2354, or with -2, -3, ... where that is taken.
std::filesystem::path fresh_directory();

}  // namespace zwang
