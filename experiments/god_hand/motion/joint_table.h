#pragma once

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {

// A table of numbers with a header line: what comma-separated joint angles come in. NaN stands for what is empty, nan,
// null or infinite.
struct JointTable {
  std::filesystem::path file;
  std::vector<std::string> columns;
  struct Row {
    std::size_t line;  // of the file, from 1
    std::vector<double> values;
  };
  std::vector<Row> rows;

  [[noreturn]] void refuse(const std::string& why) const;  // BadFile
  std::size_t column(const std::string& name) const;       // throws BadFile with the nearest name
  std::optional<std::size_t> find(const std::string& name) const;
  // Throws BadFile for a column that is none of these.
  void only(const std::vector<std::string>& names) const;
};

// Throws BadFile: the line, and what was expected.
JointTable parse_table(const std::filesystem::path& file, const std::string& text);

// zwang's own columns (docs/motion.md): palm poses and angles of one or two hands, clamped to their limits.
HandMotion plain_motion(const JointTable& table);

// The joints of a simulated Adroit hand, with its columns (DAPG): 0.01 s a step.
Recording adroit_recording(const JointTable& table);
inline bool is_adroit(const JointTable& table) { return table.find("FFJ2") || table.find("ARRx"); }

}  // namespace zwang::god
