#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace zwang::report {

// Runs a script of this folder with Node, as ./zwang sets it up: its output is passed through. Throws
// std::runtime_error when it cannot start or ends with an error.
void run_script(const std::string& script, std::vector<std::string> words);

// The charts of an experiment's findings as DIR/NAME.svg (draw.mjs).
inline void draw(const std::filesystem::path& findings, const std::filesystem::path& directory) {
  run_script("draw.mjs", {findings.string(), directory.string()});
}

}  // namespace zwang::report
