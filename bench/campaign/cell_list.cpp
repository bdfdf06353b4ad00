#include <zwang/bench/campaign/cell_list.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/results/record_file.h>
#include <zwang/bench/results/seal.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

// The first value that differs: "commit "a", not "b"".
std::string first_difference(const Json& ours, const Json& theirs) {
  for (const auto& [name, value] : ours.items())
    if (const Json other = theirs.value(name, Json()); other != value)
      return name + " " + other.dump() + ", not " + value.dump();
  return "";
}

}  // namespace

CellList::CellList(const std::filesystem::path& directory) : directory_(directory) {
  from_record(directory, [&] {
    const Json record = Json::parse(load_record(directory, "run"));
    Json conditions = Json::object();
    for (const char* name : {"zwang", "commit", "dirty", "compiler", "flags", "build_type", "libraries"})
      conditions[name] = record.at(name);
    conditions_ = conditions.dump();
    commit_ = record.at("commit");
    Json options = record.at("options");
    shard_ = read_shard(options.at("shard"));
    options.erase("shard");
    options_ = options.dump();
    const Json &names = record.at("problem_names"), &hashes = record.at("problem_sha256");
    for (std::size_t i = 0; i < hashes.size(); ++i) problems_.push_back({names.at(i), hashes[i]});
    for (const Json& solver : record.at("solvers")) solvers_.push_back(solver.at("name"));
    tolerances_ = record.at("tolerances").get<std::vector<double>>();
    return 0;
  });
}

CellKey CellList::key(std::size_t cell) const {
  const std::size_t problem = cell / runs(), run = cell % runs();
  return {problem_file(problem), problems_[problem].sha256, solvers_[run / tolerances_.size()],
          tolerances_[run % tolerances_.size()]};
}

std::string CellList::describe(std::size_t cell) const {
  const CellKey k = key(cell);
  return k.problem_file + " " + problems_[cell / runs()].name + "   " + k.solver + " @ " + printed("%.0e", k.tolerance);
}

std::size_t CellList::find(std::size_t problem, const std::string& solver, double tolerance,
                           const std::string& cell) const {
  const auto s = std::ranges::find(solvers_, solver);
  const auto t = std::ranges::find(tolerances_, tolerance);
  if (problem >= problems_.size() || s == solvers_.end() || t == tolerances_.end()) return size();
  const std::size_t at =
      (problem * solvers_.size() + static_cast<std::size_t>(s - solvers_.begin())) * tolerances_.size() +
      static_cast<std::size_t>(t - tolerances_.begin());
  return key(at).name(commit_) == cell ? at : size();
}

std::string CellList::difference(const CellList& other) const {
  const std::string where = other.directory_.string() + " does not mix with " + directory_.string() + ": ";
  if (std::string d = first_difference(Json::parse(conditions_), Json::parse(other.conditions_)); !d.empty())
    return where + d;
  for (std::size_t i = 0; i < std::min(problems_.size(), other.problems_.size()); ++i)
    if (problems_[i].name == other.problems_[i].name && problems_[i].sha256 != other.problems_[i].sha256)
      return where + "its " + problem_file(i) + " is another problem of the name " + problems_[i].name;
  if (std::string d = first_difference(Json::parse(options_), Json::parse(other.options_)); !d.empty())
    return where + d;
  for (std::size_t i = 0; i < std::max(problems_.size(), other.problems_.size()); ++i)
    if (i >= problems_.size() || i >= other.problems_.size() || problems_[i].sha256 != other.problems_[i].sha256)
      return where + "its list of problems is another one from " + problem_file(i) + " on";
  return "";
}

std::size_t for_each_line(const std::filesystem::path& directory, const CellList& cells,
                          const std::function<void(const StoredLine&)>& use) {
  std::ifstream in(directory / "results.jsonl", std::ios::binary);
  std::size_t damaged = 0;
  std::uint64_t start = 0;
  for (std::string line; std::getline(in, line); start += line.size() + 1) {
    std::size_t cell = cells.size();
    std::string machine;
    if (!in.eof() && is_intact(line)) {
      const Json record = Json::parse(line, nullptr, false);
      if (record.is_object() && record.contains("cell") && record.contains("tolerance"))
        cell = cells.find(record.value("batch", std::size_t{0}), record.value("solver", ""),
                          record.value("tolerance", 0.0), record.value("cell", ""));
      machine = record.is_object() ? record.value("machine", "") : "";
    }
    if (cell == cells.size())
      ++damaged;
    else
      use({cell, start, line, std::move(machine)});
  }
  return damaged;
}

std::vector<bool> cells_there(const CellList& cells, const std::vector<std::filesystem::path>& directories) {
  std::vector<bool> there(cells.size(), false);
  for (const auto& directory : directories) {
    if (const std::string d = cells.difference(CellList(directory)); !d.empty()) throw BadFile(d);
    for_each_line(directory, cells, [&](const StoredLine& line) { there[line.cell] = true; });
  }
  return there;
}

}  // namespace zwang
