#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// What pack.json says of one problem (docs/packs.md).
struct PackedProblem {
  std::string file = {};    // within the pack
  std::string sha256 = {};  // problem_sha256: the name by which answers call it
  std::string name = {}, family = {}, law = {};
  Index n = 0, m = 0, equalities = 0;
  std::string known = "nothing";  // of its answer: "answer", "some answer", "infeasible", "nothing"
  std::string method = {};        // by which it is known
  friend bool operator==(const PackedProblem&, const PackedProblem&) = default;
};

// A folder of problem files with one index.
class Pack {
 public:
  // Throws BadFile, with what was expected of pack.json.
  explicit Pack(std::filesystem::path directory);

  const std::filesystem::path& directory() const { return directory_; }
  const std::vector<PackedProblem>& problems() const { return problems_; }
  std::vector<std::filesystem::path> files() const;
  const PackedProblem* find(const std::string& sha256) const;  // null: none

  // Reads every problem and throws BadFile where a file or the index is not what the other says.
  void check() const;

 private:
  std::filesystem::path directory_;
  std::vector<PackedProblem> problems_;
};

// A pack made from seeds, of packs.json.
struct NamedPack {
  std::string name, line;
  std::vector<std::pair<std::string, std::optional<Law>>> scenes;  // and the law; none: the problem's own
};
std::span<const NamedPack> named_packs();

// The problems of "guard", of scenes ("hand(contacts=4)"), or of files, each once by its contents. Throws
// std::invalid_argument or BadFile.
std::vector<Instance> problems_of_pack(const std::vector<std::string>& words, std::uint64_t seed);

using PackProgress = std::function<void(std::size_t, const std::string& name)>;  // problems done, and the next one

// Writes the problems with what is known of their answers, and the index: the same bytes for the same problems.
// `cache`: of references. Returns how many there are. Throws BadFile.
std::size_t write_pack(const std::filesystem::path& directory, std::vector<Instance> problems,
                       const std::string& made_by, const std::filesystem::path& cache, const PackProgress& progress);

}  // namespace zwang
