#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "experiments/god/recording.h"

namespace zwang::god {

// The rows of a LeapJS Playback recording, one after another; a header names their columns.
class LeapRows {
 public:
  struct Row {
    double time = 0;                                       // s
    std::array<std::optional<RecordedHand>, 2> hand = {};  // right, left
    std::array<bool, 2> seen = {};                         // there, if perhaps torn
  };

  // Throws std::invalid_argument with what is wrong with the header.
  explicit LeapRows(const nlohmann::json& header);

  // False: the row is torn. `frame` is its number, for the faults.
  bool read(const nlohmann::json& row, std::size_t frame, Row& out);

  std::string fault = {};                      // the first that was found in a row
  std::array<std::string, 2> hand_fault = {};  // the first that was found in a right, a left hand

 private:
  std::optional<RecordedHand> read_hand(const nlohmann::json& h, const nlohmann::json& fingers, std::string& why) const;

  // Where the columns stand.
  struct Columns {
    std::size_t time, hands, fingers;                // of a row
    std::size_t id, side, direction, normal, place;  // of a hand
    std::size_t hand, bases, type, tool;             // of a finger; of the last three, none: not there
    std::array<std::size_t, 4> joint;
  };
  Columns at_ = {};
  std::size_t hand_width_ = 0, finger_width_ = 0;
  std::array<std::string, 2> followed_ = {};  // the id of the hand of each side that was read last
};

inline constexpr std::array side_name = {"right", "left"};
inline constexpr std::array finger_name = {"thumb", "index finger", "middle finger", "ring finger", "little finger"};

}  // namespace zwang::god
