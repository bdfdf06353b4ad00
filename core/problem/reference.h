#pragma once

#include <string>

#include <zwang/core/problem/types.h>

namespace zwang {

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

}  // namespace zwang
