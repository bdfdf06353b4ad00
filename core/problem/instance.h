#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

struct SceneStep;  // core/model/scene_change.h

// What is known to be true of a problem; `method` says how it was found.
struct Reference {
  bool feasible = true;
  Vector z = {};            // n, when feasible
  Vector lambda = {};       // m, one valid choice; may be empty when only z is known
  Vector certificate = {};  // m, when infeasible: u with u_I >= 0, J'u = 0, c'u > 0; may be empty
  double bound = 0;         // upper bound on |z - z*|_M / max(|z_u|_M, |z*|_M); 0 when z is z*
  bool unique = true;       // false: one of several solutions, or not known to be the only one (Coulomb's law)
  bool hearsay = false;     // read from a file: nobody here has proven it
  std::string method = {};  // "mpfr 100 digits", "CGAL exact", "closed form", "known answer", "file", ...
};

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

// The name of row i: its origin, or "row 17" where nobody named it; "" for -1.
std::string row_name(const Instance& instance, Index i);

}  // namespace zwang
