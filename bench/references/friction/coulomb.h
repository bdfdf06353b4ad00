#pragma once

#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/instance.h>
#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// A solution of Coulomb's law that interval Newton proved (core/referee/friction/interval_newton.h), rounded once.
struct CoulombSolution {
  Vector z = {}, lambda = {};
  double bound = 0;                     // |z - solution|_M / s, its rounding to doubles included
  double radius = 0;                    // of the proof alone, |.|_M / s
  double delta = 0;                     // > 0: it solves a c (or z_u) this far from the problem's, not these rows
  bool strict = false;                  // all modes hold with something to spare
  bool isolated = false;                // proven: strict and of unique forces, so that no other z lies arbitrarily near
  bool free_split = false;              // forces that are free to change move z
  bool continuum = false;               // proven of them: infinitely many z lie next to each other
  bool by_slopes = false;               // the second witness proves it, too (natural_map.h)
  std::vector<ContactMode> modes = {};  // of the contacts, in the order of their rows; c_n = -Inf is none
  std::string method = {};              // "interior point", "Gauss-Seidel", ...
};

struct SolutionSearch {
  int starts = 6;         // of the interior point; sizes from .03 to 100
  int random_starts = 0;  // of nsgs, beyond the one from zero
  int sweeps = 3000;
  int mode_choices = 0;           // of all open, stuck and sliding contacts, where there are no more choices than this
  std::vector<Vector> near = {};  // motions to begin at
  std::uint64_t seed = 1;
  bool all = false;                // look on after the first
  Deadline deadline = Deadline();  // no start after it
};

// Proven solutions, no two of them alike: the balls that hold them are apart, and where forces are
// free to change and move z, one stands for all of the same modes. Interior point on Coulomb's law from several sizes,
// in wider arithmetic where doubles are not enough, then nsgs (solvers/friction/nsgs.h); each is polished on the modes
// it ends at and proven. Then what `search` says: motions given, and Newton's method from choices of modes. Empty where
// nothing was proven; `why_not` then says what came nearest. What proves shares no code with a solver. Dense: O(rows^3)
// an iteration.
std::vector<CoulombSolution> coulomb_solutions(const Problem& problem, const SolutionSearch& search = {},
                                               std::string* why_not = nullptr);

// The first of them with delta = 0 as a reference that is one of possibly several.
std::optional<Reference> coulomb_reference(const Problem& problem, std::string* why_not = nullptr);

// The one answer of the convex law, with what duality proves of it; empty where that is more than 1e-9.
std::optional<Reference> convex_reference(const Problem& problem, std::string* why_not = nullptr);

}  // namespace zwang
