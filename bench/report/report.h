#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/report/tables/accuracy.h>

namespace zwang::report {

// All three read a run's folder (docs/formats.md) and throw std::runtime_error with one line on what is wrong with it.

// DIR/report.html: one file that opens offline. Of a suite's results or, where they are there, of collision.json.
std::filesystem::path write_report(const std::filesystem::path& run);

// Two runs side by side: two commits, or a solver added to stored results. A solver that both runs hold appears twice,
// as "name @A" and "name @B"; problems are the same where their contents are.
std::filesystem::path write_comparison(const std::filesystem::path& run_a, const std::filesystem::path& run_b,
                                       const std::filesystem::path& out);

// What is drawn for a paper: only these charts, solvers and families. Empty: all charts and families, and the six best
// solvers of each class of problems.
struct Figures {
  std::vector<std::string> formats = {};  // svg, pdf
  std::vector<std::string> charts = {}, solvers = {}, families = {};
  double width = 0;  // of a chart [in]; 0: its own
};

// DIR/figures/*.svg and *.pdf, to each its caption as *.txt; DIR/tables/*.tex and *.csv. Needs Node and rsvg-convert,
// as ./zwang sets them up. Returns the files written. Throws std::invalid_argument for a name that is not there.
std::vector<std::filesystem::path> write_figures(const std::filesystem::path& run, const Figures& figures);

}  // namespace zwang::report
