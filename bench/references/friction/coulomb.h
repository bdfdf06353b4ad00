#pragma once

#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// A solution of Coulomb's law that interval Newton proved (core/referee/friction/interval_newton.h), rounded once.
struct CoulombSolution {
  Vector z = {}, lambda = {};
  double bound = 0;   // |z - solution|_M / s, its rounding to doubles included
  double radius = 0;  // of the proof alone, |.|_M / s
  double delta = 0;   // the solution is exact for a c (or z_u) this far from the problem's
  bool strict = false, isolated = false;
  std::string method = {};  // "interior point", "Gauss-Seidel"
};

struct SolutionSearch {
  int starts = 6;         // of the interior point; sizes from .03 to 100
  int random_starts = 0;  // of Gauss-Seidel, beyond the one from zero
  int sweeps = 3000;
  std::uint64_t seed = 1;
  bool all = false;  // look on after the first
};

// Proven solutions, no two of them alike. Interior point on Coulomb's law from several sizes, in wider arithmetic where
// doubles are not enough, then block Gauss-Seidel with exact local solves; each is polished on the modes it ends at and
// proven. Empty where nothing was proven; `why_not` then says what came nearest. Shares no code with a solver. Dense:
// O(rows^3) an iteration.
std::vector<CoulombSolution> coulomb_solutions(const Problem& problem, const SolutionSearch& search = {},
                                               std::string* why_not = nullptr);

// The first of them as a reference that is one of possibly several.
std::optional<Reference> coulomb_reference(const Problem& problem, std::string* why_not = nullptr);

// The one answer of the convex law, with what duality proves of it; empty where that is more than 1e-9.
std::optional<Reference> convex_reference(const Problem& problem, std::string* why_not = nullptr);

}  // namespace zwang
