#pragma once

#include <filesystem>
#include <span>

#include <zwang/experiments/god_hand/run/run_record.h>
#include <zwang/experiments/god_hand/run/summary.h>

namespace zwang::god {

// DIR/replay.html: the run of this folder in 3D, one file that needs no network (docs/god-hand.md). Of a long run one
// frame in every few is shown, the most telling one: a wrong one before a stuck, a held, an untracked one and the
// first. `models`: one per hand. Throws BadFile when the frames are broken or the page cannot be written.
std::filesystem::path write_replay(const std::filesystem::path& directory, const Record& record, const Summary& summary,
                                   const Surroundings& surroundings, std::span<const hand::Model> models);

inline constexpr long most_frames_shown = 3000;
inline constexpr std::size_t most_triangles_shown = 100000;

}  // namespace zwang::god
