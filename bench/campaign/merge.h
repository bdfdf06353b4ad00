#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace zwang {

// What merge() found.
struct Merged {
  std::size_t planned = 0, present = 0;              // runs of the whole suite
  std::size_t damaged = 0;                           // lines left out
  std::size_t twice = 0;                             // runs that several folders hold and agree on
  std::vector<std::string> disagreeing = {};         // runs that they do not agree on, one line each
  std::vector<std::string> bad_problems = {};        // problem files that are missing or not what their hash says
  std::map<std::string, std::size_t> machines = {};  // CPU -> runs
};

// Joins parts of one suite into `out`: one run, its lines in the order of the suite, whatever the parts' order was.
// Of a run that is there twice the first is kept. Memory: 16 bytes a run. Throws BadFile in one line where a part is of
// another program, suite, problem or list of tolerances.
Merged merge(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& out,
             const std::string& command);

}  // namespace zwang
