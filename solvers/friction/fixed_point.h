#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/setting.h>
#include <zwang/solvers/solver_entry.h>

namespace zwang {

// Coulomb's law by convex problems: z solves it exactly where z = Z(sigma(z)), sigma the slips |s_t(z)| and Z(sigma)
// the answer under the convex law with c_n - mu sigma in place of c_n (De Saxce & Feng 1998, Math. Comput. Modelling
// 28; Acary, Cadoux, Lemarechal & Malick 2011, Z. Angew. Math. Mech. 91). sigma <- |s_t(z)| from sigma = 0, each Z by
// the solver `inner` of the convex law, from the multipliers of the last, and no more accurate than the slips are
// known.
//
// One iteration is one solve by `inner`. What `inner` claims does not count: `solved` is claimed where z and lambda
// pass the test of the solvers on cones under Coulomb's law (ConeIteration). Where no answer exists for some slips,
// larger ones are tried; what has none under the convex law may have one under Coulomb's, so infeasibility is never
// claimed.
struct FixedPoint {
  static constexpr std::string_view name = "fixed_point";
  static constexpr auto laws = laws_that<lifts>;
  static constexpr bool needs_friction = true;

  std::function<AnySolver(const std::string&)> make = {};  // a solver of the convex law from `inner`, or throws
  std::string inner = "cone";
  std::optional<AnySolver> solver = {};  // that `inner` names
  int max_rounds = 500;
  double relaxation = 1;

  static std::vector<Setting<FixedPoint>> settings() {
    return {{"inner", &FixedPoint::inner, "the solver of the convex law, with its own settings: inner=cone:finish=off"},
            {"max_rounds", &FixedPoint::max_rounds, "convex problems before giving up"},
            {"relaxation", &FixedPoint::relaxation, "how far the slips go to the new ones, above 0 up to 1"}};
  }
  void complete();
  std::string supports(const Problem& problem) const;
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  ConeIteration iteration = {};
  Problem shifted = {};
  Solution answer = {};
  WarmStart warm = {};
  Vector sigma = {};  // at the rows of the contacts

 private:
  bool solve_shifted(const Problem& problem, const SolveOptions& options, Solution& solution);
};
static_assert(Solver<FixedPoint>);

}  // namespace zwang
