#pragma once

#include <string>
#include <vector>

#include <zwang/bench/report/results.h>

namespace zwang::report {

// The runs of a large run one by one, for scripts beside the page: a page opened from disk may load a script, but not
// fetch data.
struct SingleRuns {
  std::vector<std::string> scripts = {};  // runs/0.js, ...: zwang_runs(0, {"problem": [row, ...], ...})
  std::string index = {};                 // JSON: {"family": [["problem", script], ...], ...}
};
SingleRuns single_run_scripts(const RunFolder& run);

}  // namespace zwang::report
