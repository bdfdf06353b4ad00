#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// Tangent rows of a contact with mu > 0 become the inequality rows N +- mu T in place of N (edges), or stay, with
// forces in the cone K.
enum class Tangents : unsigned char { left_out, edges, kept };

// All that a law says to everybody but the referee, which has its own (core/referee/friction/law.h). A further law is
// one more line, in the order of enum Law (docs/add-a-law.md).
struct LawEntry {
  std::string_view name;  // in files, in tables and on the command line
  Tangents tangents;
  double lift;  // this part of mu |s_t| is added to s_n before it meets the force: from 0 to 1
};
inline constexpr std::array law_entries{LawEntry{"frictionless", Tangents::left_out, 0},
                                        LawEntry{"pyramid", Tangents::edges, 0}, LawEntry{"convex", Tangents::kept, 0},
                                        LawEntry{"coulomb", Tangents::kept, 1}};

constexpr const LawEntry& entry_of(Law law) { return law_entries[static_cast<std::size_t>(law)]; }
constexpr bool reads_mu(Law law) { return entry_of(law).tangents != Tangents::left_out; }
constexpr bool has_edges(Law law) { return entry_of(law).tangents == Tangents::edges; }
constexpr bool has_cones(Law law) { return entry_of(law).tangents == Tangents::kept; }
constexpr double lift_of(Law law) { return entry_of(law).lift; }
constexpr bool lifts(Law law) { return lift_of(law) > 0; }
// Gauss' principle: at most one z, and a certificate where there is none.
constexpr bool is_convex(Law law) { return !lifts(law); }

inline constexpr auto all_laws = [] {
  std::array<Law, law_entries.size()> all{};
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<Law>(k);
  return all;
}();
// Those of which `is` holds: static constexpr auto laws = laws_that<has_cones>; of a solver.
template <bool (*is)(Law)>
inline constexpr auto laws_that = [] {
  std::array<Law, at(std::ranges::count_if(all_laws, is))> some{};
  std::ranges::copy_if(all_laws, some.begin(), is);
  return some;
}();

// The law of the same rows in which slip lifts nothing.
constexpr Law without_lift(Law law) {
  return *std::ranges::find_if(
      all_laws, [=](Law other) { return entry_of(other).tangents == entry_of(law).tangents && !lifts(other); });
}

// Of rows without tangents; and of rows with them as they stand in files and in scenes.
inline constexpr Law no_friction = Law::frictionless, stored_law = Law::coulomb;

constexpr std::string_view to_string(Law law) {
  return static_cast<std::size_t>(law) < law_entries.size() ? entry_of(law).name : "unknown";
}
// Throws std::invalid_argument with the words there are.
Law parse_law(std::string_view word);

// The problem under another law. Tangent rows are left out (frictionless), become the edges N +- mu T of a pyramid in
// place of their inequality row (pyramid: its dual cone lies around K*), or stay as they are (convex, coulomb). A
// contact with mu = 0 has no tangent rows under any law: K is then a ray, met exactly and not as a limit.
// A problem without tangent rows is the same under every law, and is returned as it is: frictionless.
// What stands in the files and in a scene is under coulomb; from pyramid or frictionless there is no way back.
Problem under(Law law, const Problem& problem);

// A row of the problem under another law: row `normal` of this one, plus factor x row `tangent` where there is one.
struct RowUnder {
  Index normal, tangent = -1;
  double factor = 0;
  int edge = -1;  // of a pyramid
};
std::vector<RowUnder> rows_under(Law law, const Problem& problem);

}  // namespace zwang
