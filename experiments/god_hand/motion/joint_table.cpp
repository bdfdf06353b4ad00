#include <zwang/experiments/god_hand/motion/joint_table.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <ranges>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang::god {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (const auto cell : std::views::split(line, ',')) cells.push_back(trimmed({cell.begin(), cell.end()}));
  return cells;
}

// False: not a number at all.
bool number(std::string_view cell, double& out) {
  out = std::numeric_limits<double>::quiet_NaN();
  if (cell.empty() || cell == "null") return true;
  if (cell.front() == '+') cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), out);
  if (error == std::errc::invalid_argument || end != cell.data() + cell.size()) return false;
  if (error != std::errc() || !std::isfinite(out)) out = std::numeric_limits<double>::quiet_NaN();
  return true;
}

// What no hand does: numbers in other units.
constexpr double full_turn = 6.28, fastest = 20,
                 widest = 5;  // rad beyond a joint's limits, m/s, m from its usual place

// The median of the palm's speed between rows [m/s].
double usual_speed(const Track& track) {
  std::vector<double> speeds;
  for (std::size_t k = 1; k < track.keys.size(); ++k) {
    const Track::Key &from = track.keys[k - 1], &to = track.keys[k];
    speeds.push_back((to.target.palm.position - from.target.palm.position).norm() / (to.time - from.time));
  }
  return upper_median(std::move(speeds));
}

}  // namespace

void JointTable::refuse(const std::string& why) const { throw BadFile(file.string() + ": " + one_line(why)); }

std::optional<std::size_t> JointTable::find(const std::string& name) const {
  const auto found = std::ranges::find(columns, name);
  return found == columns.end() ? std::nullopt : std::optional(at(found - columns.begin()));
}

std::size_t JointTable::column(const std::string& name) const {
  const auto found = find(name);
  if (!found) refuse("line 1: no column '" + name + "'" + did_you_mean(name, columns));
  return *found;
}

void JointTable::only(const std::vector<std::string>& names) const {
  for (const std::string& c : columns) {
    if (std::find(names.begin(), names.end(), c) == names.end())
      refuse("line 1: unknown column '" + c + "'" + did_you_mean(c, names));
    if (std::count(columns.begin(), columns.end(), c) > 1) refuse("line 1: column '" + c + "' is there twice");
  }
}

JointTable parse_table(const std::filesystem::path& file, const std::string& text) {
  JointTable table{.file = file, .columns = {}, .rows = {}};
  std::string_view rest = text;
  if (rest.starts_with("\xff\xfe") || rest.starts_with("\xfe\xff")) table.refuse("UTF-16; text in UTF-8 expected");
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);  // a byte order mark
  std::size_t line = 0;
  for (const auto text_of_line : std::views::split(rest, '\n')) {
    ++line;
    const std::string_view here = trimmed({text_of_line.begin(), text_of_line.end()});
    if (here.empty()) continue;
    const std::vector<std::string_view> cells = cells_of(here);
    if (table.columns.empty()) {
      if (cells.size() == 1 && here.find_first_of(";\t") != std::string_view::npos)
        table.refuse("line " + std::to_string(line) + ": no commas; columns are separated by them");
      table.columns.assign(cells.begin(), cells.end());
      continue;
    }
    const std::string where = "line " + std::to_string(line) + ": ";
    if (cells.size() != table.columns.size())
      table.refuse(where + std::to_string(cells.size()) + " columns, the header has " +
                   std::to_string(table.columns.size()));
    JointTable::Row row{.line = line, .values = std::vector<double>(cells.size())};
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (!number(cells[k], row.values[k]))
        table.refuse(where + "column '" + table.columns[k] + "' is '" + std::string(cells[k].substr(0, 20)) +
                     "', a number expected");
    table.rows.push_back(std::move(row));
  }
  if (table.columns.empty()) table.refuse("an empty file; a line of column names expected");
  if (table.rows.size() < 2) table.refuse("no motion: a line of column names and two or more of numbers expected");
  return table;
}

HandMotion plain_motion(const JointTable& table) {
  constexpr const char* palm[7] = {"palm_x", "palm_y", "palm_z", "palm_qw", "palm_qx", "palm_qy", "palm_qz"};
  std::vector<std::string> of_hand(palm, palm + 7), known = {"time"};
  for (int a = 0; a < hand::angles; ++a) {
    of_hand.push_back(hand::angle_name(a));
    std::replace(of_hand.back().begin(), of_hand.back().end(), ' ', '_');
  }
  std::vector<std::string> prefixes;
  for (const std::string prefix : {"", "right_", "left_"}) {
    bool any = false;
    for (const std::string& name : of_hand) any |= table.find(known.emplace_back(prefix + name)).has_value();
    if (any) prefixes.push_back(prefix);
  }
  if (prefixes.empty()) prefixes = {""};  // whose columns are missed below
  table.only(known);
  if (prefixes.size() > 1 && prefixes[0].empty()) table.refuse("line 1: columns with and without 'right_', 'left_'");

  const std::size_t time = table.column("time");
  struct Timed {
    double time;
    const std::vector<double>* values;
  };
  std::vector<Timed> rows;
  for (const JointTable::Row& row : table.rows)
    if (std::isfinite(row.values[time])) rows.push_back({row.values[time], &row.values});
  const std::size_t timeless = table.rows.size() - rows.size();
  if (2 * timeless >= table.rows.size()) table.refuse("most rows have no time; seconds expected");
  HandMotion motion;
  note(motion.notes, timeless, "without a time");
  note(motion.notes, put_in_order(rows), "with the time of another");
  if (rows.size() < 2) table.refuse("all rows have one time; seconds expected");
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (rows[k].time - rows[k - 1].time > 600) table.refuse("more than 10 minutes between two rows; seconds expected");
  motion.duration = rows.back().time - rows.front().time;
  if (motion.duration > 2 * static_cast<double>(rows.size()))
    table.refuse("less than a row in two seconds; seconds expected");

  for (const std::string& prefix : prefixes) {
    Track track{.model = prefix == "left_" ? hand::mirrored(hand::standard()) : hand::standard()};
    const auto at = mapped(of_hand, [&](const std::string& name) { return table.column(prefix + name); });
    double sum = 0;
    for (const Timed& row : rows) {
      const auto value = [&](std::size_t k) { return (*row.values)[at[k]]; };
      Target target;
      target.palm.position = {value(0), value(1), value(2)};
      const Eigen::Quaterniond q(value(3), value(4), value(5), value(6));
      target.palm.rotation = q.normalized().toRotationMatrix();
      for (std::size_t a = 0; a < target.angles.size(); ++a) target.angles[a] = value(7 + a);
      const Target raw = target;
      double beyond = 0;
      for (int a = 0; a < hand::angles; ++a) {
        double& angle = target.angles[static_cast<std::size_t>(a)];
        const hand::Range limit = track.model.range(a);
        beyond = std::max({beyond, limit.low - angle, angle - limit.high});
        if (std::isfinite(angle)) angle = std::clamp(angle, limit.low, limit.high);
      }
      target.tracked = std::abs(q.norm() - 1) < 0.05 && !(beyond > full_turn);
      const std::size_t held = track.held_over;
      append(track, {row.time - rows.front().time, target});
      if (track.held_over > held) continue;
      track.beyond = std::max(track.beyond, beyond);
      const hand::Poses got = hand::forward_kinematics(target.palm, target.angles, track.model);
      const hand::Poses asked = hand::forward_kinematics(raw.palm, raw.angles, track.model);
      for (int b = 1; b < hand::bodies; ++b) {
        const auto body = static_cast<std::size_t>(b);
        const Vec3 end(0, track.model.phalanx(b).length / 2, 0);
        const double miss = (got[body] * end - asked[body] * end).norm();
        track.misfit_most = std::max(track.misfit_most, miss);
        sum += miss;
      }
    }
    const std::size_t sound = rows.size() - track.held_over;
    if (2 * sound < rows.size())
      table.refuse(
          "most rows have a NaN, a palm 1000 m away, a quaternion of another length than 1 or an angle more than a "
          "turn beyond its limits among the columns of the hand; metres and radians expected");
    if (track.beyond > 0)
      motion.notes.push_back("angles up to " + printed("%.3g", track.beyond) +
                             " rad beyond the hand's limits: clamped");
    if (const double speed = usual_speed(track); speed > fastest)
      table.refuse("the palm goes at " + printed("%.3g", speed) +
                   " m/s and more in half of the rows; metres and seconds expected");
    const auto palms = mapped(track.keys, [](const Track::Key& key) { return key.target.palm.position; });
    if (const double distance = usual_place(palms).distance; distance > widest)
      table.refuse("the palm is " + printed("%.3g", distance) +
                   " m and more from its usual place in half of the rows; metres expected");
    track.misfit_mean = sum / (15 * static_cast<double>(sound));
    motion.hands.push_back(std::move(track));
  }
  return motion;
}

}  // namespace zwang::god
