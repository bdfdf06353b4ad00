#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/core/problem/reference.h>

namespace zwang {

struct SceneStep;  // core/model/scene_change.h

// Who wrote a row, and its unit. In files and in results it reads "type/label", or "type/label [row]" where the
// constraint has several rows.
struct RowOrigin {
  std::string type = {};   // "contact"
  std::string label = {};  // "box 3 on box 2"
  int row = -1;            // within the constraint; -1: its only one
  std::string unit = {};   // of J z - c, "m/s^2" or "rad/s^2"; "" where it is not known
  friend bool operator==(const RowOrigin&, const RowOrigin&) = default;
};

std::string constraint_name(const RowOrigin& origin);  // "type/label"
std::string to_string(const RowOrigin& origin);
RowOrigin parse_row_origin(std::string_view text, std::string unit = {});

// What somebody else answered when the problem was recorded: judged like a solver's answer, never timed.
struct RecordedAnswer {
  std::string by = {};  // "mujoco"
  Vector z = {};        // n
};

// A problem together with what names it, what made it, and what is known about it.
struct Instance {
  Problem problem = {};
  std::string family = {};  // groups problems in charts: "hand", "MR", "fclib"
  std::string knob = {};    // the parameter that is swept in this family, or ""
  double knob_value = 0;
  std::uint64_t seed = 0;
  std::vector<RowOrigin> origin = {};   // m; empty when nobody named them
  std::vector<std::string> notes = {};  // what a reader changed or assumed, one line each
  std::optional<Reference> reference = {};
  std::vector<RecordedAnswer> recorded = {};
  std::shared_ptr<const SceneStep> step = {};  // what the problem was assembled of, where a scene says so
};

// The problem under another law (law.h), with the names of its rows. A reference, and what was recorded, answer one
// law: they stay only where it is the same.
Instance under(Law law, Instance instance);

// The name of row i: its origin, or "row 17" where nobody named it; "" for -1.
std::string row_name(const Instance& instance, Index i);

}  // namespace zwang
