#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"

namespace zwang::god {

// One hand as it was recorded: m, world axes with z up, nothing closed or limited yet.
struct RecordedHand {
  Pose<double> palm = {};                                 // axes as in hand::Model, origin where the recording has it
  std::array<std::array<Vec3, 4>, 5> joints = {};         // base, second and third joint, tip of thumb .. little finger
  double bone(std::size_t finger, std::size_t k) const {  // m
    return (joints[finger][k + 1] - joints[finger][k]).norm();
  }
};

struct RecordedTrack {
  struct Frame {
    double time;                       // s, ascending
    std::optional<RecordedHand> hand;  // none: not seen, NaN or torn
  };
  bool left = false;
  std::vector<Frame> frames = {};
};

struct Recording {
  std::vector<RecordedTrack> hands = {};  // one or two, the right one first
  std::vector<std::string> notes = {};    // what was passed over, one line each, for people
};

// The text of a LeapJS Playback recording: {metadata, frames}, frames[0] the nested header that names the columns.
// Throws BadFile naming `file`.
Recording parse_leap(const std::filesystem::path& file, const std::string& text);

}  // namespace zwang::god
