#include <zwang/experiments/god_hand/motion/leap_rows.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/core/problem/did_you_mean.h>

namespace zwang::god {
namespace {

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

}  // namespace

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

}  // namespace zwang::god
