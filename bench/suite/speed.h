#pragma once

#include <atomic>
#include <filesystem>
#include <span>

#include <zwang/bench/suite/plan.h>

namespace zwang {

// What the speed suite measures beside its batches, as DIR/speed.jsonl (docs/formats.md): sequences of frames, cold and
// warm, assembly, and where dual_active_set's time goes. Written anew in each call; takes up to `budget` seconds of
// solving. False when interrupted. `cache`: of references (suite.h).
bool write_speed(const std::filesystem::path& directory, const std::filesystem::path& cache, std::span<const Run> runs,
                 double budget, Dispatcher& desk, const std::atomic<bool>& interrupted);

// DIR/speed.jsonl of a plan whose problems are successive frames: each family in its order, cold and warm, by every
// solver at its tightest tolerance, however long that takes.
void write_sequences(const Plan& plan, const std::filesystem::path& directory, const std::filesystem::path& cache,
                     Dispatcher& desk, const std::atomic<bool>& interrupted);

}  // namespace zwang
