#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <zwang/bench/results/result.h>

namespace zwang {

// One problem before and after a change of a solver.
struct Change {
  enum class Kind { same, better, less_accurate, wrong_forces, newly_unsolved, newly_wrong };
  std::string problem = {};
  Kind kind = Kind::same;
  Verdict before = Verdict::undecided, after = Verdict::undecided;
  double error_before = unknown, error_after = unknown;  // proven, relative to the motion; wrong_forces: residuals
};
std::string_view to_string(Change::Kind kind);  // "newly wrong", ...

// How many problems, right before and after, moved one way and the other, and whether that is more than chance: the
// difference is beyond `sigmas` standard deviations of a fair coin.
struct Drift {
  static constexpr double sigmas = 5;
  std::string what = {}, worse = {}, better = {};  // "proven error", "larger", "smaller"
  std::size_t up = 0, down = 0;
  bool alarm() const;
};

// What a change did to a solver's answers.
struct Guarded {
  std::vector<Change> changes = {};  // one a problem
  // Of errors; iterations where these bought no accuracy; claims; answers that another solver gave; times, where every
  // one after is above, or below, every one before (two runs a side or more).
  std::vector<Drift> drifts = {};
  std::size_t count(Change::Kind kind) const;
  std::size_t worse() const;   // problems that became so
  const Drift* alarm() const;  // the first drift that is more than chance, or null
  bool is_worse() const { return worse() > 0 || alarm(); }
};

// Rows of the same problems, a vector a repeated run; the worst verdict of repeated runs stands for all.
Guarded compare(const std::vector<std::vector<Result>>& before, const std::vector<std::vector<Result>>& after);

std::string describe(const Guarded& guarded, std::size_t most);  // for people: counts, then at most so many problems
std::string to_map(const Guarded& guarded);    // SVG: a square a problem, coloured by what happened to it
std::string to_badge(const Guarded& guarded);  // SVG
std::string to_junit(const Guarded& guarded);

}  // namespace zwang
