#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {
namespace {

using Json = nlohmann::json;

constexpr std::array side_name = {"right", "left"};
constexpr std::array finger_name = {"thumb", "index finger", "middle finger", "ring finger", "little finger"};
constexpr std::array joint_column = {"mcpPosition", "pipPosition", "dipPosition", "btipPosition"};

// A row of a LeapJS Playback recording.
struct LeapRow {
  double time = 0;                                       // s
  std::array<std::optional<RecordedHand>, 2> hand = {};  // right, left
  std::array<bool, 2> seen = {};                         // there, if perhaps torn
};

// The columns of a list, in their order.
struct Columns {
  std::vector<std::string> names = {};

  bool has(std::string_view name) const { return std::ranges::find(names, name) != names.end(); }
  std::size_t operator[](std::string_view name) const { return at(std::ranges::find(names, name) - names.begin()); }
};

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
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  Recording read(const std::string& text) {
    const Json frames = frames_in(text);
    read_header(frames[0]);
    for (std::size_t k = 1; k < frames.size(); ++k)
      if (LeapRow row; read_row(frames[k], "frame " + std::to_string(k) + ": ", row)) rows_.push_back(std::move(row));
    const std::size_t torn = frames.size() - 1 - rows_.size();
    if (torn >= rows_.size()) refuse(fault_);
    Recording out;
    const std::size_t repeated = put_in_order(rows_);
    note(out.notes, torn, "torn: " + fault_);
    note(out.notes, repeated, "with the time stamp of another");
    check_times(repeated);

    std::array<RecordedTrack, 2> track;
    std::array<std::size_t, 2> kept = {};
    std::size_t others = 0;
    for (std::size_t s = 0; s < 2; ++s) {
      track[s].left = s == 1;
      std::size_t seen = 0, sound = 0;
      for (const LeapRow& row : rows_) {
        track[s].frames.push_back({row.time - rows_.front().time, row.hand[s]});
        seen += row.seen[s];
        sound += row.hand[s].has_value();
      }
      if (2 * sound < seen) refuse(hand_fault_[s]);
      if (sound == 0) continue;
      const std::size_t odd = drop_odd(track[s]);
      const std::string of_hand = "of the " + std::string(side_name[s]) + " hand ";
      if (2 * odd > sound) refuse("the bones " + of_hand + "change their lengths");
      note(out.notes, seen - sound, of_hand + "torn: " + hand_fault_[s]);
      note(out.notes, odd, of_hand + "with a bone of another length");
      const std::size_t mirrored = drop_mirrored(track[s]);
      note(out.notes, mirrored, of_hand + "with the fingers of the other hand");
      kept[s] = 2 * mirrored > sound ? 0 : sound - odd - mirrored;
      others += mirrored;
    }
    for (std::size_t s = 0; s < 2; ++s) {
      const bool passing = kept[s] < 3 || (20 * kept[s] < rows_.size() && kept[1 - s] > 10 * kept[s]);
      if (kept[s] > 0 && !passing) out.hands.push_back(std::move(track[s]));
      if (passing) note(out.notes, kept[s], std::string("show a ") + side_name[s] + " hand: passed over");
    }
    if (out.hands.empty() && others > 0)
      refuse(
          "its hands have the fingers of the other hand: x to the right, y up, z toward the user, and from thumb to "
          "little finger expected");
    if (out.hands.empty()) refuse("no hand in three or more of its " + counted(rows_.size(), "frame"));
    return out;
  }

 private:
  [[noreturn]] void refuse(std::string why) const {
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw BadFile(file_.string() + ": " + why);
  }

  // Of {"metadata": ..., "frames": [header, row, ...]}.
  Json frames_in(const std::string& text) const {
    Json whole;
    try {
      whole = Json::parse(with_null_for_nan(text));
    } catch (const Json::parse_error& e) {
      refuse("not whole JSON: broken off or torn near byte " + std::to_string(std::min(e.byte, text.size())) + " of " +
             std::to_string(text.size()));
    } catch (const Json::exception&) {
      refuse("not JSON that can be read: a number out of range");
    }
    if (!whole.is_object() || !whole.contains("frames") || !whole["frames"].is_array())
      refuse(R"(no Leap recording: {"metadata": ..., "frames": [header, row, ...]} expected)");
    if (whole["frames"].size() < 2) refuse("no frames after the header");
    return std::move(whole["frames"]);
  }

  Columns columns(const Json& header, const char* of, std::initializer_list<const char*> needed) const {
    Columns out;
    for (const Json& column : header) {
      const bool nested = column.is_object() && column.size() == 1;
      out.names.push_back(column.is_string() ? column.get<std::string>() : nested ? column.begin().key() : "");
    }
    for (const char* name : needed)
      if (!out.has(name))
        refuse(std::string("the header's ") + of + " have no column '" + name + "'" + did_you_mean(name, out.names));
    return out;
  }

  void read_header(const Json& header) {
    if (!header.is_array()) refuse("frames[0] is no header: a list of column names expected");
    row_ = columns(header, "rows", {"timestamp", "hands", "pointables"});
    const auto nested = [&](const std::string& name) {
      const Json& column = header[row_[name]];
      const Json* list = column.is_object() ? &column.begin().value() : nullptr;
      if (list == nullptr || !list->is_array() || list->empty() || !(*list)[0].is_array())
        refuse("the header's '" + name + "' does not name its columns: {\"" + name + "\": [[...]]} expected");
      return (*list)[0];
    };
    const Json hands = nested("hands"), fingers = nested("pointables");
    hand_ = columns(hands, "hands", {"id", "type", "direction", "palmNormal", "palmPosition"});
    finger_ =
        columns(fingers, "pointables", {"handId", joint_column[0], joint_column[1], joint_column[2], joint_column[3]});
  }

  // False: the row is torn. `here`: its number, for the faults.
  bool read_row(const Json& row, const std::string& here, LeapRow& out) {
    const auto torn = [&](const std::string& why) {
      if (fault_.empty()) fault_ = here + why;
      return false;
    };
    if (!row.is_array() || row.size() <= std::max({row_["timestamp"], row_["hands"], row_["pointables"]}))
      return torn("a row of fewer columns than the header's");
    if (!number(row[row_["timestamp"]], out.time)) return torn("its time stamp is no number");
    out.time *= 1e-6;
    const Json &hands = row[row_["hands"]], &fingers = row[row_["pointables"]];
    if (!hands.is_array() || !fingers.is_array()) return torn("its hands and pointables are no lists");
    for (const Json& h : hands) {
      if (!h.is_array() || h.size() < hand_.names.size()) return torn("a hand of fewer columns than the header's");
      const Json& type = h[hand_["type"]];
      const std::size_t s = type == "left" ? 1 : 0;
      if (type != "left" && type != "right") return torn("a hand's type is neither \"left\" nor \"right\"");
      // Of two hands of one side the one that was followed so far counts.
      const std::string id = h[hand_["id"]].dump();
      if (out.seen[s] && id != followed_[s]) continue;
      std::string why;
      out.seen[s] = true;
      out.hand[s] = read_hand(h, fingers, why);
      if (out.hand[s])
        followed_[s] = id;
      else if (hand_fault_[s].empty())
        hand_fault_[s] = here + "the " + side_name[s] + " hand's " + why;
    }
    return true;
  }

  std::optional<RecordedHand> read_hand(const Json& h, const Json& fingers, std::string& why) const {
    RecordedHand out;
    Vec3 ahead, normal, place;
    const auto bad = [&](const std::string& what) {
      why = what;
      return std::nullopt;
    };
    if (!vector(h[hand_["direction"]], ahead)) return bad("direction is not three numbers");
    if (!vector(h[hand_["palmNormal"]], normal)) return bad("palmNormal is not three numbers");
    if (!vector(h[hand_["palmPosition"]], place)) return bad("palmPosition is not three numbers");
    const Vec3 y = turned(ahead).normalized(), z = (-turned(normal) + y * y.dot(turned(normal))).normalized();
    if (!(y.squaredNorm() > 0.5 && z.squaredNorm() > 0.5)) return bad("direction and palmNormal span no frame");
    out.palm.rotation << y.cross(z), y, z;
    out.palm.position = in_metres(place);

    std::size_t count = 0;
    std::array<bool, 5> met = {};
    for (const Json& f : fingers) {
      if (!f.is_array() || f.size() < finger_.names.size())
        return bad("pointables are torn: fewer columns than the header's");
      if (f[finger_["handId"]] != h[hand_["id"]]) continue;
      if (finger_.has("tool") && f[finger_["tool"]] == true) continue;
      std::size_t which = count++;
      if (finger_.has("type") && f[finger_["type"]].is_number_unsigned()) which = f[finger_["type"]].get<std::size_t>();
      if (which > 4 || met[which]) return bad("fingers are not thumb, index, middle, ring and little finger");
      met[which] = true;
      for (std::size_t k = 0; k < 4; ++k) {
        Vec3 p;
        if (!vector(f[finger_[joint_column[k]]], p))
          return bad(std::string(finger_name[which]) + ": " + joint_column[k] + " is not three numbers");
        out.joints[which][k] = in_metres(p);
      }
      if (finger_.has("bases") && (!f[finger_["bases"]].is_array() || f[finger_["bases"]].size() != 4))
        return bad(std::string(finger_name[which]) + ": bases are not those of 4 bones");
    }
    if (count != 5) return bad("fingers in pointables are " + std::to_string(count) + ", 5 expected");
    return out;
  }

  void check_times(std::size_t repeated) const {
    if (rows_.size() < 2)
      refuse(repeated > 0 ? "all frames have one time stamp: microseconds expected" : "a single frame is no motion");
    for (std::size_t k = 1; k < rows_.size(); ++k)
      if (rows_[k].time - rows_[k - 1].time > 600)
        refuse("more than 10 minutes between two frames: time stamps in microseconds expected");
    const double whole = rows_.back().time - rows_.front().time, frames = static_cast<double>(rows_.size());
    if (whole > 2 * frames) refuse("less than a frame in two seconds: time stamps in microseconds expected");
    if (whole < 1e-4 * frames) refuse("more than 10,000 frames a second: time stamps in microseconds expected");
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
      refuse(printed("a bone of the %s is %g mm long: millimetres and a hand's bones expected", finger_name[b / 3],
                     1e3 * usual[b]));
    }
    for (auto& f : track.frames)
      for (std::size_t b = 0; b < 15 && f.hand; ++b)
        if (!(std::abs(f.hand->bone(b / 3, b % 3) - usual[b]) <= 0.1 * usual[b] + 2e-3)) f.hand.reset(), ++odd;
    return odd;
  }

  // Of a right hand that looks down the index finger is to the left of the little one. Where it is not, axes are
  // mirrored, or the tracker took one hand for the other.
  static std::size_t drop_mirrored(RecordedTrack& track) {
    std::size_t count = 0;
    for (auto& f : track.frames) {
      if (!f.hand) continue;
      const double right = f.hand->palm.rotation.col(0).dot(f.hand->joints[1][0] - f.hand->joints[4][0]);
      if (track.left ? right < 0 : right > 0) f.hand.reset(), ++count;
    }
    return count;
  }

  const std::filesystem::path& file_;
  Columns row_, hand_, finger_;
  std::array<std::string, 2> followed_ = {};  // the id of the hand of each side that was read last
  std::vector<LeapRow> rows_ = {};            // those that are not torn
  std::string fault_ = {};                    // the first that was found in a row
  std::array<std::string, 2> hand_fault_;     // the first that was found in a right, a left hand
};

}  // namespace

Recording parse_leap(const std::filesystem::path& file, const std::string& text) { return Reader(file).read(text); }

}  // namespace zwang::god
