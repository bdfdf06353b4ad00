#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {
namespace {

constexpr std::array side_name = {"right", "left"};
constexpr std::array finger_name = {"thumb", "index finger", "middle finger", "ring finger", "little finger"};

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

using Json = nlohmann::json;
constexpr std::array joint_column = {"mcpPosition", "pipPosition", "dipPosition", "btipPosition"};
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

std::vector<std::string> names_of(const Json& header) {
  std::vector<std::string> names;
  for (const Json& column : header) {
    if (column.is_string())
      names.push_back(column.get<std::string>());
    else
      names.push_back(column.is_object() && column.size() == 1 ? column.begin().key() : std::string());
  }
  return names;
}

std::size_t column(const std::vector<std::string>& names, const std::string& name, const char* where,
                   bool must = true) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  if (must)
    throw std::invalid_argument(std::string("the header's ") + where + " have no column '" + name + "'" +
                                did_you_mean(name, names));
  return none;
}

bool number(const Json& value, double& out) {
  if (!value.is_number()) return false;
  out = value.get<double>();
  return std::isfinite(out);
}
bool vector(const Json& value, Vec3& out) {
  return value.is_array() && value.size() == 3 && number(value[0], out[0]) && number(value[1], out[1]) &&
         number(value[2], out[2]);
}
// The device looks up along y, from a table whose far side is -z; here z is up and the far side is y. mm to m.
Vec3 turned(const Vec3& v) { return {v.x(), -v.z(), v.y()}; }
Vec3 in_metres(const Vec3& v) { return 1e-3 * turned(v); }

// How rows are read that stand under `header`; what is wrong with them goes to `faults`.
class RowReader {
 public:
  RowReader(const Json& header, LeapRows& faults);

  // False: the row is torn. `frame` is its number, for the faults.
  bool read(const Json& row, std::size_t frame, LeapRow& out);

 private:
  std::optional<RecordedHand> read_hand(const Json& h, const Json& fingers, std::string& why) const;

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
  LeapRows& faults_;
};

RowReader::RowReader(const Json& header, LeapRows& faults) : faults_(faults) {
  if (!header.is_array()) throw std::invalid_argument("frames[0] is no header: a list of column names expected");
  const auto nested = [&](std::size_t at, const char* name) {
    const Json* list = header[at].is_object() ? &header[at].begin().value() : nullptr;
    if (list == nullptr || !list->is_array() || list->empty() || !(*list)[0].is_array())
      throw std::invalid_argument(std::string("the header's '") + name + "' does not name its columns: {\"" + name +
                                  "\": [[...]]} expected");
    return names_of((*list)[0]);
  };
  const std::vector<std::string> rows = names_of(header);
  at_.time = column(rows, "timestamp", "rows");
  at_.hands = column(rows, "hands", "rows");
  at_.fingers = column(rows, "pointables", "rows");
  const std::vector<std::string> hands = nested(at_.hands, "hands"), fingers = nested(at_.fingers, "pointables");
  at_.id = column(hands, "id", "hands");
  at_.side = column(hands, "type", "hands");
  at_.direction = column(hands, "direction", "hands");
  at_.normal = column(hands, "palmNormal", "hands");
  at_.place = column(hands, "palmPosition", "hands");
  at_.hand = column(fingers, "handId", "pointables");
  for (std::size_t k = 0; k < 4; ++k) at_.joint[k] = column(fingers, joint_column[k], "pointables");
  at_.bases = column(fingers, "bases", "pointables", false);
  at_.type = column(fingers, "type", "pointables", false);
  at_.tool = column(fingers, "tool", "pointables", false);
  hand_width_ = hands.size();
  finger_width_ = fingers.size();
}

bool RowReader::read(const Json& row, std::size_t frame, LeapRow& out) {
  const std::string here = "frame " + std::to_string(frame) + ": ";
  out = {};
  const auto torn = [&](const std::string& why) {
    if (faults_.fault.empty()) faults_.fault = here + why;
    return false;
  };
  if (!row.is_array() || row.size() <= std::max({at_.time, at_.hands, at_.fingers}))
    return torn("a row of fewer columns than the header's");
  if (!number(row[at_.time], out.time)) return torn("its time stamp is no number");
  out.time *= 1e-6;
  if (!row[at_.hands].is_array() || !row[at_.fingers].is_array()) return torn("its hands and pointables are no lists");
  for (const Json& h : row[at_.hands]) {
    if (!h.is_array() || h.size() < hand_width_) return torn("a hand of fewer columns than the header's");
    const Json& type = h[at_.side];
    const std::size_t s = type == "left" ? 1 : 0;
    if (type != "left" && type != "right") return torn("a hand's type is neither \"left\" nor \"right\"");
    // Of two hands of one side the one that was followed so far counts.
    if (out.seen[s] && h[at_.id].dump() != followed_[s]) continue;
    std::string why;
    out.seen[s] = true;
    out.hand[s] = read_hand(h, row[at_.fingers], why);
    if (out.hand[s])
      followed_[s] = h[at_.id].dump();
    else if (faults_.hand_fault[s].empty())
      faults_.hand_fault[s] = here + "the " + side_name[s] + " hand's " + why;
  }
  return true;
}

std::optional<RecordedHand> RowReader::read_hand(const Json& h, const Json& fingers, std::string& why) const {
  RecordedHand out;
  Vec3 ahead, normal, place;
  const auto bad = [&](const std::string& what) {
    why = what;
    return std::nullopt;
  };
  if (!vector(h[at_.direction], ahead)) return bad("direction is not three numbers");
  if (!vector(h[at_.normal], normal)) return bad("palmNormal is not three numbers");
  if (!vector(h[at_.place], place)) return bad("palmPosition is not three numbers");
  const Vec3 y = turned(ahead).normalized(), z = (-turned(normal) + y * y.dot(turned(normal))).normalized();
  if (!(y.squaredNorm() > 0.5 && z.squaredNorm() > 0.5)) return bad("direction and palmNormal span no frame");
  out.palm.rotation << y.cross(z), y, z;
  out.palm.position = in_metres(place);

  std::size_t count = 0;
  std::array<bool, 5> met = {};
  for (const Json& f : fingers) {
    if (!f.is_array() || f.size() < finger_width_) return bad("pointables are torn: fewer columns than the header's");
    if (f[at_.hand] != h[at_.id]) continue;
    if (at_.tool != none && f[at_.tool] == true) continue;
    std::size_t which = count++;
    if (at_.type != none && f[at_.type].is_number_unsigned()) which = f[at_.type].get<std::size_t>();
    if (which > 4 || met[which]) return bad("fingers are not thumb, index, middle, ring and little finger");
    met[which] = true;
    for (std::size_t k = 0; k < 4; ++k) {
      Vec3 p;
      if (!vector(f[at_.joint[k]], p))
        return bad(std::string(finger_name[which]) + ": " + joint_column[k] + " is not three numbers");
      out.joints[which][k] = in_metres(p);
    }
    if (at_.bases != none && (!f[at_.bases].is_array() || f[at_.bases].size() != 4))
      return bad(std::string(finger_name[which]) + ": bases are not those of 4 bones");
  }
  if (count != 5) return bad("fingers in pointables are " + std::to_string(count) + ", 5 expected");
  return out;
}

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

// `text`: {"metadata": ..., "frames": [header, row, ...]}; the header names the columns.
// Throws std::invalid_argument with what is wrong: with the JSON, or with the header.
LeapRows read_leap_rows(const std::string& text) {
  Json whole;
  try {
    whole = Json::parse(with_null_for_nan(text));
  } catch (const Json::parse_error& e) {
    throw std::invalid_argument("not whole JSON: broken off or torn near byte " +
                                std::to_string(std::min(e.byte, text.size())) + " of " + std::to_string(text.size()));
  } catch (const Json::exception&) {
    throw std::invalid_argument("not JSON that can be read: a number out of range");
  }
  if (!whole.is_object() || !whole.contains("frames") || !whole["frames"].is_array())
    throw std::invalid_argument(R"(no Leap recording: {"metadata": ..., "frames": [header, row, ...]} expected)");
  const Json& frames = whole["frames"];
  if (frames.size() < 2) throw std::invalid_argument("no frames after the header");

  LeapRows out;
  RowReader reader(frames[0], out);
  for (std::size_t k = 1; k < frames.size(); ++k)
    if (LeapRow row; reader.read(frames[k], k, row)) out.rows.push_back(std::move(row));
  out.torn = frames.size() - 1 - out.rows.size();
  return out;
}

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
