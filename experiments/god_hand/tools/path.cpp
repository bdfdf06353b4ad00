#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/motion/joint_table.h>
#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

std::optional<HandMotion> read_path(const std::filesystem::path& file, const Tool& tool) {
  const StoredFile stored = read_stored(file);
  if (stored.kind() != ".csv") return std::nullopt;
  const JointTable table = parse_table(file, unpacked(stored, std::size_t{1} << 30));
  if (!table.find("qw")) return std::nullopt;
  std::vector<std::string> names = {"time", "x", "y", "z", "qw", "qx", "qy", "qz", "close"};
  for (const Tool::Drive& drive : tool.drives) names.push_back(drive.name);
  table.only(names);
  std::array<std::size_t, 8> column;
  for (std::size_t k = 0; k < column.size(); ++k) column[k] = table.column(names[k]);
  const std::optional<std::size_t> close = table.find("close");
  auto hinges = mapped(tool.drives, [&](const Tool::Drive& drive) { return table.find(drive.name); });
  if (std::ranges::none_of(hinges, [](const auto& column) { return column.has_value(); })) hinges.clear();
  HandMotion motion{.name = file.stem().string(), .hands = {Track{.model = hand::standard()}}};
  double last = -1e300, begin = 0;
  for (const JointTable::Row& row : table.rows) {
    const auto value = [&](std::size_t k) { return row.values[column[k]]; };
    if (motion.hands[0].keys.empty()) begin = value(0);
    if (!std::isfinite(value(0)) || value(0) <= last)
      table.refuse("line " + std::to_string(row.line) + ": times that grow expected");
    last = value(0);
    Target target;
    const Eigen::Quaterniond q(value(4), value(5), value(6), value(7));
    target.palm = {{value(1), value(2), value(3)}, q.normalized().toRotationMatrix()};
    if (close) target.angles[Tool::closing] = row.values[*close];
    target.tracked = is_usable(target.palm) && q.norm() > 0.5 && std::isfinite(target.angles[Tool::closing]);
    for (const auto& hinge : hinges) {
      target.hinges.push_back(hinge ? row.values[*hinge] : std::numeric_limits<double>::quiet_NaN());
      target.tracked = target.tracked && (!hinge || std::isfinite(target.hinges.back()));
    }
    append(motion.hands[0], {value(0) - begin, target});
  }
  if (motion.hands[0].keys.empty()) table.refuse("no line with a pose");
  motion.duration = motion.hands[0].keys.back().time;
  motion.hands[0].patience = std::max(motion.hands[0].patience, motion.duration);
  return motion;
}

}  // namespace zwang::god
