#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/motion/leap_rows.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {
namespace {

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  Recording read(const std::string& text) {
    LeapRows read = rows_of(text);
    std::vector<LeapRow>& rows = read.rows;
    if (read.torn >= rows.size()) refuse(read.fault);
    const std::size_t repeated = put_in_order(rows);
    note(read.torn, "torn: " + read.fault);
    note(repeated, "with the time stamp of another");
    check_times(rows);

    std::array<RecordedTrack, 2> track;
    for (std::size_t s = 0; s < 2; ++s) {
      track[s].left = s == 1;
      std::size_t seen = 0, sound = 0;
      for (const LeapRow& row : rows) {
        track[s].frames.push_back({row.time - rows.front().time, row.hand[s]});
        seen += row.seen[s];
        sound += row.hand[s].has_value();
      }
      if (2 * sound < seen) refuse(read.hand_fault[s]);
      if (sound == 0) continue;
      const std::size_t odd = drop_odd(track[s]);
      if (2 * odd > sound) refuse("the bones of the " + std::string(side_name[s]) + " hand change their lengths");
      note(seen - sound, "of the " + std::string(side_name[s]) + " hand torn: " + read.hand_fault[s]);
      note(odd, "of the " + std::string(side_name[s]) + " hand with a bone of another length");
      kept_[s] = sound - odd;
    }
    for (std::size_t s = 0; s < 2; ++s) {
      const bool passing = kept_[s] < 3 || (20 * kept_[s] < rows.size() && kept_[1 - s] > 10 * kept_[s]);
      if (kept_[s] > 0 && !passing) out_.hands.push_back(std::move(track[s]));
      if (kept_[s] > 0 && passing) note(kept_[s], std::string("show a ") + side_name[s] + " hand: passed over");
    }
    if (out_.hands.empty()) refuse("no hand in its " + std::to_string(rows.size()) + " frames");
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(std::string why) const {
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw BadFile(file_.string() + ": " + why);
  }
  void note(std::size_t count, const std::string& what) { god::note(out_.notes, count, what); }
  LeapRows rows_of(const std::string& text) const {
    try {
      return read_leap_rows(text);
    } catch (const std::invalid_argument& wrong) {
      refuse(wrong.what());
    }
  }

  void check_times(const std::vector<LeapRow>& rows) const {
    if (rows.size() < 2) refuse("a single frame is no motion");
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (rows[k].time - rows[k - 1].time > 600)
        refuse("more than 10 minutes between two frames: time stamps in microseconds expected");
    if (rows.back().time - rows.front().time > 2 * static_cast<double>(rows.size()))
      refuse("less than a frame in two seconds: time stamps in microseconds expected");
    if (rows.back().time - rows.front().time < 1e-4 * static_cast<double>(rows.size()))
      refuse("more than 10,000 frames a second: time stamps in microseconds expected");
  }

  // The tracker fits a rigid hand, so a frame in which a bone has another length than it mostly has is torn.
  std::size_t drop_odd(RecordedTrack& track) const {
    std::size_t odd = 0;
    std::array<double, 15> usual;
    for (std::size_t b = 0; b < 15; ++b) {
      std::vector<double> lengths;
      for (const auto& f : track.frames)
        if (f.hand) lengths.push_back(f.hand->bone(b / 3, b % 3));
      usual[b] = upper_median(lengths);
      if (usual[b] > 2e-3 && usual[b] < 0.2) continue;
      std::ostringstream text;
      text << "a bone of the " << finger_name[b / 3] << " is " << 1e3 * usual[b]
           << " mm long: millimetres and a hand's bones expected";
      refuse(text.str());
    }
    for (auto& f : track.frames)
      for (std::size_t b = 0; b < 15 && f.hand; ++b)
        if (!(std::abs(f.hand->bone(b / 3, b % 3) - usual[b]) <= 0.1 * usual[b] + 2e-3)) f.hand.reset(), ++odd;
    return odd;
  }

  const std::filesystem::path& file_;
  std::array<std::size_t, 2> kept_ = {};
  Recording out_;
};

}  // namespace

Recording parse_leap(const std::filesystem::path& file, const std::string& text) { return Reader(file).read(text); }

}  // namespace zwang::god
