#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/problem_file.h"
#include "experiments/god/leap_rows.h"
#include "experiments/god/recording.h"

namespace zwang::god {
namespace {

using Json = nlohmann::json;

// NaN and Infinity are no JSON, but recorders write them: they become null, which is no number either.
std::string with_null_for_nan(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  bool quoted = false;
  for (std::size_t k = 0; k < text.size();) {
    std::size_t word = 0;
    if (!quoted)
      for (const std::string_view bare : {"NaN", "Infinity", "-Infinity"})
        if (text.compare(k, bare.size(), bare) == 0) word = bare.size();
    if (word > 0) {
      out += "null";
      k += word;
      continue;
    }
    if (quoted && text[k] == '\\' && k + 1 < text.size()) out += text[k++];
    if (text[k] == '"') quoted = !quoted;
    out += text[k++];
  }
  return out;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, const std::string& text) : file_(file) {
    try {
      whole_ = Json::parse(with_null_for_nan(text));
    } catch (const Json::parse_error& e) {
      refuse("not whole JSON: broken off or torn near byte " + std::to_string(std::min(e.byte, text.size())) + " of " +
             std::to_string(text.size()));
    } catch (const Json::exception&) {
      refuse("not JSON that can be read: a number out of range");
    }
    if (!whole_.is_object() || !whole_.contains("frames") || !whole_["frames"].is_array())
      refuse("no Leap recording: {\"metadata\": ..., \"frames\": [header, row, ...]} expected");
    if (whole_["frames"].size() < 2) refuse("no frames after the header");
  }

  Recording read() {
    using Row = LeapRows::Row;
    std::vector<Row> rows;
    const Json& frames = whole_["frames"];
    LeapRows reader = under(frames[0]);
    for (std::size_t k = 1; k < frames.size(); ++k)
      if (Row row; reader.read(frames[k], k, row)) rows.push_back(std::move(row));
    const std::size_t torn = frames.size() - 1 - rows.size();
    if (2 * torn >= frames.size() - 1) refuse(reader.fault);
    const std::size_t repeated = put_in_order(rows);
    if (torn > 0) note(torn, "torn: " + reader.fault);
    if (repeated > 0) note(repeated, "with the time stamp of another");
    check_times(rows);

    std::array<RecordedTrack, 2> track;
    for (std::size_t s = 0; s < 2; ++s) {
      track[s].left = s == 1;
      std::size_t seen = 0, sound = 0;
      for (const Row& row : rows) {
        track[s].frames.push_back({row.time - rows.front().time, row.hand[s]});
        seen += row.seen[s];
        sound += row.hand[s].has_value();
      }
      if (2 * sound < seen) refuse(reader.hand_fault[s]);
      if (sound == 0) continue;
      const std::size_t odd = drop_odd(track[s]);
      if (2 * odd > sound) refuse("the bones of the " + std::string(side_name[s]) + " hand change their lengths");
      if (seen > sound)
        note(seen - sound, "of the " + std::string(side_name[s]) + " hand torn: " + reader.hand_fault[s]);
      if (odd > 0) note(odd, "of the " + std::string(side_name[s]) + " hand with a bone of another length");
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
  void note(std::size_t count, const std::string& what) { out_.notes.push_back(god::frames(count, what)); }
  LeapRows under(const Json& header) const {
    try {
      return LeapRows(header);
    } catch (const std::invalid_argument& wrong) {
      refuse(wrong.what());
    }
  }

  template <class Rows>
  void check_times(const Rows& rows) const {
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
      const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
      std::nth_element(lengths.begin(), middle, lengths.end());
      usual[b] = *middle;
      if (!(usual[b] > 2e-3 && usual[b] < 0.2))
        refuse("a bone of the " + std::string(finger_name[b / 3]) + " is " + std::to_string(1e3 * usual[b]) +
               " mm long: millimetres and a hand's bones expected");
    }
    for (auto& f : track.frames)
      for (std::size_t b = 0; b < 15 && f.hand; ++b)
        if (!(std::abs(f.hand->bone(b / 3, b % 3) - usual[b]) <= 0.1 * usual[b] + 2e-3)) f.hand.reset(), ++odd;
    return odd;
  }

  const std::filesystem::path& file_;
  Json whole_;
  std::array<std::size_t, 2> kept_ = {};
  Recording out_;
};

}  // namespace

Recording parse_leap(const std::filesystem::path& file, const std::string& text) { return Reader(file, text).read(); }

}  // namespace zwang::god
