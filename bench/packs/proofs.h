#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include <zwang/bench/packs/answers.h>

namespace zwang {

// What was written, and why there is no proof of the other answers.
struct ProofTally {
  std::size_t written = 0;
  std::map<std::string, std::size_t> without = {};  // by reason
};

// For each answer that is proven right or wrong: a file DIR/SOLVER/0000.json that names the rows which prove it, and
// how far the answer is from the true one, to 20 digits; beside it DIR/problems/0000.json, the problem's numbers.
// docs/checker/check.py verifies both in rationals, without zwang (docs/packs.md). What is written was found in 100
// digits, in which a row that holds and one that is off in its last bit differ by far. Throws BadFile.
ProofTally write_proofs(const Pack& pack, std::span<const Answers> contestants, const std::filesystem::path& directory,
                        const PackProgress& progress, const std::atomic<bool>& interrupted);

}  // namespace zwang
