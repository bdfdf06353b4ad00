#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {

// A row of a LeapJS Playback recording.
struct LeapRow {
  double time = 0;                                       // s
  std::array<std::optional<RecordedHand>, 2> hand = {};  // right, left
  std::array<bool, 2> seen = {};                         // there, if perhaps torn
};

// Those of a whole recording that are not torn, in its order.
struct LeapRows {
  std::vector<LeapRow> rows;
  std::size_t torn = 0;
  std::string fault = {};                      // the first that was found in a row
  std::array<std::string, 2> hand_fault = {};  // the first that was found in a right, a left hand
};

// `text`: {"metadata": ..., "frames": [header, row, ...]}; the header names the columns.
// Throws std::invalid_argument with what is wrong: with the JSON, or with the header.
LeapRows read_leap_rows(const std::string& text);

inline constexpr std::array side_name = {"right", "left"};
inline constexpr std::array finger_name = {"thumb", "index finger", "middle finger", "ring finger", "little finger"};

}  // namespace zwang::god
