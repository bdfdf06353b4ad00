#pragma once

#include <zwang/bench/references/friction/coulomb.h>

namespace zwang {

// What is known of how many solutions Coulomb's law has.
struct SolutionCount {
  enum class Kind {
    all,        // solutions holds all there are
    continuum,  // infinitely many, proven
    at_least,   // solutions holds those that were found
    none_found
  };
  Kind kind = Kind::none_found;
  std::size_t proven = 0;       // of `solutions`: exact for this problem; the first of them
  bool by_enumeration = false;  // every choice of modes was solved in rationals
  std::vector<CoulombSolution> solutions = {};
  std::string why_not = {};  // where there are none: what came nearest
};

// Looks for all of them: the searches of coulomb_solutions() from many starts, and enumeration in rationals where the
// problem is planar and has at most six contacts. Starts no further search after `seconds` of CPU time.
SolutionCount count_solutions(const Problem& problem, double seconds);

std::string in_words(const SolutionCount& count);  // one line

}  // namespace zwang
