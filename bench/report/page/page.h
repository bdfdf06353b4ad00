#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {

// What a page says of its run as a whole.
struct PageText {
  std::string title;
  std::vector<std::string> headline;  // sentences, most important first
  std::string opening;                // the section whose picture answers the question of the run's suite
  std::string circumstances;
  std::vector<std::string> notes;
  std::vector<SolverInfo> solvers;
  std::vector<Table> tables;
};
PageText page_text(const RunFolder& run);

std::vector<std::string> headline(const RunFolder& run);

// Everything the page and the figures draw, as one JSON object: of by_class(). `single`: the index of
// single_run_scripts(), or "". A table's rows from most_rows on are left out, which its note then says.
std::string page_data(const PageText& text, const std::vector<RunFolder>& classes, const std::string& single = "",
                      std::size_t most_rows = 2000);

// Rows of all charts as one JSON object {chart: {fields: [..], rows: [[..], ..]}}, aggregated so that a page draws at
// most 2,000 marks a chart; every single run stays in results.jsonl.
std::string chart_rows(const RunFolder& run);

// The runs of a large run one by one, for scripts beside the page: a page opened from disk may load a script, but not
// fetch data.
struct SingleRuns {
  std::vector<std::string> scripts = {};  // runs/0.js, ...: zwang_runs(0, {"problem": [row, ...], ...})
  std::string index = {};                 // JSON: {"family": [["problem", script], ...], ...}
};
SingleRuns single_run_scripts(const RunFolder& run);

// The pages embedded at build time with the data in their place: of page_data(), of collision.json and of league.py.
std::string page(const std::string& data);
std::string page_with_scripts(const std::string& data);  // that may load scripts beside it
std::string collision_page(const std::string& data);
std::string league_page(const std::string& data);
// Any bundled page with its slot for data filled.
std::string filled(std::string_view page, const std::string& data);

}  // namespace zwang::report
