#include <zwang/bench/results/cell.h>

#include <nlohmann/json.hpp>

#include <zwang/bench/results/result.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

std::string CellKey::name(const std::string& commit) const {
  const std::string digits = printed("%.17g", tolerance);
  return sha256(commit + '\n' + problem_file + '\n' + problem_sha256 + '\n' + solver + '\n' + digits).substr(0, 32);
}

std::string without_clock(const std::string& line) {
  nlohmann::json record = nlohmann::json::parse(line);
  if (record.value("claimed", "") == "time limit") return record.value("cell", "") + " time limit";
  const Result any;
  Result::columns(any, Columns{[&record](const std::string& key, const auto&, const Column& column) {
                    if (column.of_clock) record.erase(key);
                  }});
  record.erase("check");
  return record.dump();
}

std::string problem_file(std::size_t position) { return printed("problems/%04zu.h5", position); }

}  // namespace zwang
