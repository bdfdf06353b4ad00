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

// Each chart for a paper: DIR/figures/*.svg and *.pdf (formats: "svg", "pdf"), DIR/tables/*.tex and *.csv. Needs Node
// and rsvg-convert, as ./zwang sets them up. Returns the files written.
std::vector<std::filesystem::path> write_figures(const std::filesystem::path& run,
                                                 const std::vector<std::string>& formats);

}  // namespace zwang::report
