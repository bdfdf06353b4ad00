#pragma once

#include <zwang/experiments/questions/question.h>

namespace zwang::questions {

// The table as text, columns aligned.
std::string to_text(const Findings& findings);

// DIR/NAME.csv, DIR/NAME.json (the charts' values and everything else) and DIR/CHART.svg for each chart, drawn by Vega;
// needs Node, as ./zwang sets it up. Returns the files written. Throws std::runtime_error with one line.
std::vector<std::filesystem::path> record(const Findings& findings, const Question& question,
                                          const std::string& command, const std::filesystem::path& directory);

}  // namespace zwang::questions
