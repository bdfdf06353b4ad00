#pragma once

#include <string>
#include <string_view>

namespace zwang {

// What stands for a solver in the row of an answer that came with its problem: "recorded:mujoco". Such a row has no
// time, and is no run: its `claimed` is "unsolved", since nobody solved it here.
constexpr std::string_view recorded_prefix = "recorded:";
inline bool is_recorded(std::string_view solver) { return solver.starts_with(recorded_prefix); }
inline std::string recorded_name(const std::string& by) { return std::string(recorded_prefix) + by; }

}  // namespace zwang
