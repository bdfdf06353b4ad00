#pragma once

#include <atomic>
#include <filesystem>
#include <span>

#include <zwang/bench/timing/batch.h>

namespace zwang {

// DIR/conformance.jsonl: every solver on every phenomenon of friction (bench/conformance), at its tightest tolerance,
// under the nearest law to Coulomb's that it reads. One line a solver and phenomenon.
void write_phenomena(const std::filesystem::path& directory, std::span<const Run> runs, Dispatcher& desk,
                     const std::atomic<bool>& interrupted);

}  // namespace zwang
