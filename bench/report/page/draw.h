#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace zwang::report {

// Every chart of a report for print: DATA.json, the folder, the formats "svg" and "pdf". Node runs the script, which is
// part of the program; its output is passed through. Throws std::runtime_error when it cannot start or ends with an
// error.
void draw_figures(const std::filesystem::path& data, const std::filesystem::path& directory,
                  const std::vector<std::string>& formats);

// The charts of an experiment's findings as DIR/NAME.svg. Throws likewise.
void draw(const std::filesystem::path& findings, const std::filesystem::path& directory);

}  // namespace zwang::report
