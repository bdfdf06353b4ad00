#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// What is known to be true of a problem, found without any of the solvers under test.
struct Reference {
  bool feasible = true;
  Vector z = {};            // n, when feasible
  Vector lambda = {};       // m, one valid choice; may be empty when only z is known
  Vector certificate = {};  // m, when infeasible: u with u_I >= 0, J'u = 0, c'u > 0; may be empty
  double bound = 0;         // upper bound on |z - z*|_M / max(|z_u|_M, |z*|_M); 0 when z is z* rounded once
  std::string method = {};  // "mpfr 100 digits", "CGAL exact", "closed form", "known answer", "file", ...
};

// A problem together with what names it, what made it, and what is known about it.
struct Instance {
  Problem problem = {};
  std::string family = {};  // groups problems in charts: "hand", "MR", "fclib"
  std::string knob = {};    // the parameter that is swept in this family, or ""
  double knob_value = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> origin = {};  // m names "type/label" or "type/label [row]"; empty when nobody named them
  std::vector<std::string> notes = {};   // what a reader changed or assumed, one line each
  std::optional<Reference> reference = {};
};

// "type" of an origin name: the part before the slash ("contact/box 3 on box 2" -> "contact").
inline std::string origin_type(const std::string& origin) { return origin.substr(0, origin.find('/')); }

}  // namespace zwang
