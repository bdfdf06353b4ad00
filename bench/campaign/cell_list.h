#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/bench/results/cell.h>
#include <zwang/bench/suite/plan.h>

namespace zwang {

// The cells of a run, as its run.json states them: problem by problem, solver by solver, from loose to tight.
class CellList {
 public:
  // Throws BadFile.
  explicit CellList(const std::filesystem::path& directory);

  std::size_t size() const { return problems_.size() * runs(); }  // of all parts
  bool holds(std::size_t cell) const { return shard_.holds(cell / runs()); }
  const Shard& shard() const { return shard_; }
  std::size_t problems() const { return problems_.size(); }
  const std::string& problem_sha256(std::size_t problem) const { return problems_[problem].sha256; }
  CellKey key(std::size_t cell) const;
  std::string describe(std::size_t cell) const;  // "problems/0007.h5 hand(contacts=4)   nnls @ 1e-06"

  // The place of a stored line in this list; size() where it is not one of its cells.
  std::size_t find(std::size_t problem, const std::string& solver, double tolerance, const std::string& cell) const;

  // What tells the two runs apart, in one line; "" where they are the same suite under the same program. Machines and
  // parts may differ.
  std::string difference(const CellList& other) const;

 private:
  struct NamedProblem {
    std::string name, sha256;
  };
  std::size_t runs() const { return solvers_.size() * tolerances_.size(); }

  std::filesystem::path directory_;
  std::string conditions_, options_;  // JSON, without machine and part
  std::string commit_;
  std::vector<NamedProblem> problems_;
  std::vector<std::string> solvers_;
  std::vector<double> tolerances_;
  Shard shard_;
};

// An intact line of results.jsonl.
struct StoredLine {
  std::size_t cell = 0;     // of the list
  std::uint64_t start = 0;  // its place in the file
  std::string_view text = {};
  std::string machine = {};
};

// Goes through DIR/results.jsonl in bounded memory. The number of lines that are damaged or none of the list's cells.
std::size_t for_each_line(const std::filesystem::path& directory, const CellList& cells,
                          const std::function<void(const StoredLine&)>& use);

// Of each cell of the list, whether one of the folders has it. Throws BadFile where a folder's run is another one.
std::vector<bool> cells_there(const CellList& cells, const std::vector<std::filesystem::path>& directories);

}  // namespace zwang
