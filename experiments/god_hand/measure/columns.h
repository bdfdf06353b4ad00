#pragma once

#include <array>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <zwang/experiments/god_hand/step/frame.h>

namespace zwang::god {

// A number of a frame: its name in frames.h5 and in the replay, and its unit.
struct Column {
  const char* key;
  const char* unit;
  std::variant<double Frame::*, int Frame::*, bool Frame::*, Origin Frame::*> member;

  double of(const Frame& frame) const {
    return std::visit([&](auto of) { return static_cast<double>(frame.*of); }, member);
  }
};
std::span<const Column> columns();

// Where the time of a frame goes, as people are shown it.
inline constexpr std::array<const char*, 6> stage_names = {"physics", "resolution", "assembly",
                                                           "solve",   "collision",  "other"};
std::array<double, 6> stages(const StageTimes& times);  // in that order

// What the columns come to over frames. NaN does not count.
class Totals {
 public:
  struct Range {
    double least, most, sum;  // of no frames NaN, NaN and 0
  };

  Totals();
  void add(const Frame& frame);

  const Range& of(std::string_view key) const;
  long frames() const { return frames_; }
  long touching() const { return touching_; }  // frames with a god object that touches something

 private:
  std::vector<Range> ranges_;
  long frames_ = 0, touching_ = 0;
};

}  // namespace zwang::god
