#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <zwang/core/model/pose.h>
#include <zwang/core/problem/wording.h>

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
  struct Sample {
    double time;                       // s, ascending
    std::optional<RecordedHand> hand;  // none: not seen, NaN or torn
  };
  bool left = false;
  std::vector<Sample> frames = {};
  double beyond = 0;  // rad, the farthest that an angle was outside its limits, where angles were recorded
};

struct Recording {
  std::vector<RecordedTrack> hands = {};  // one or two, the right one first
  std::vector<std::string> notes = {};    // what was passed over, one line each, for people
};

// Rows by their time, the first of each. Returns how many had the time of another.
template <class Row>
std::size_t put_in_order(std::vector<Row>& rows) {
  std::ranges::stable_sort(rows, {}, &Row::time);
  const auto again = std::ranges::unique(rows, {}, &Row::time);
  const std::size_t repeated = again.size();
  rows.erase(again.begin(), again.end());
  return repeated;
}

// Of two middle ones the larger; 0 of none.
inline double upper_median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Where points mostly are: their median along each axis, and the median of their distances from it [m].
struct Usual {
  Vec3 place = Vec3::Zero();
  double distance = 0;
};
inline Usual usual_place(const std::vector<Vec3>& points) {
  Usual out;
  std::vector<double> values(points.size());
  for (Index axis = 0; axis < 3; ++axis) {
    std::ranges::transform(points, values.begin(), [&](const Vec3& p) { return p[axis]; });
    out.place[axis] = upper_median(values);
  }
  std::ranges::transform(points, values.begin(), [&](const Vec3& p) { return (p - out.place).norm(); });
  out.distance = upper_median(std::move(values));
  return out;
}

// Adds "3 frames <what>", "1 frame <what>", nothing of none.
inline void note(std::vector<std::string>& notes, std::size_t count, const std::string& what) {
  if (count > 0) notes.push_back(counted(count, "frame") + " " + what);
}

// The text of a LeapJS Playback recording: {metadata, frames}, frames[0] the nested header that names the columns.
// Throws BadFile naming `file`.
Recording parse_leap(const std::filesystem::path& file, const std::string& text);

}  // namespace zwang::god
