#pragma once

#include <filesystem>

namespace zwang::report {

// The charts and tables of a report for print, as DATA.json asks: {"print": what is asked for, "page": page_data()}.
// Node runs the script, which is part of the program; its output is passed through. Throws std::runtime_error when it
// cannot start or ends with an error.
void draw_figures(const std::filesystem::path& data, const std::filesystem::path& figures,
                  const std::filesystem::path& tables);

// The charts of an experiment's findings as DIR/NAME.svg. Throws likewise.
void draw(const std::filesystem::path& findings, const std::filesystem::path& directory);

}  // namespace zwang::report
