#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/friction/cone_starts.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Contacts with friction, under the convex law and Coulomb's: an interior point into the regime where the modes of the
// contacts show (interior_point.h; under Coulomb's law along the central path, as far as it leads, where one of the
// first steps is blocked), then Newton's method on the modes to the last digits (mode_newton.h). Hands are solved in
// the few freedoms that their joints leave, walls by the sparse Cholesky factor of 6 x 6 blocks; islands apart, and
// together where one fails (fallback). A warm start goes to the modes at once, and to the interior point where they do
// not settle: under Coulomb's law to its path, where they came near.
//
// The sparse Cholesky factor is symmetric, so the interior point there only refreshes the shift of Coulomb's law, which
// contacts that slide can stall. It then starts again on dense rows (up to 1000 unknowns) or with sparse LU, where the
// shift is differentiated; Solution::fallback says so.
//
// Where no start leads to an answer of Coulomb's law, the convex problem of the slips at hand is solved again and
// again, as by fixed_point, and Newton's method on the modes tried from each answer (up to 1000 unknowns; a fallback,
// too). Near an answer that nothing certifies, as where contacts depend on each other, all starts share the iterations
// of one: the status is then `numerical failure`, and z the best that was found.
//
// What has no friction, a problem or a part of one, is a quadratic program and handed on (Solution::handed_to), to a
// solver that judges rows which almost depend on others in extended precision: an interior point of its own, tried
// first, claimed answers to rows that contradict each other by 1e-10.
//
// One iteration is one factorization. `solved` is claimed where, in unit rows and relative to the motion, the natural
// residual is at the tolerance and the gap, or promise.h, bounds the distance to the convex answer of this slip by ten
// times that; or where the modes hold to rounding; or where they hold to the tolerance, Newton's method on them has
// converged to it, and what is left is what rows that depend on each other disagree by. Coulomb's law may have several
// answers, or none: this is one of them.
struct Cone {
  static constexpr std::string_view name = "cone";
  static constexpr auto laws = laws_that<has_cones>;

  bool finish = true;
  struct Quadratic {
    AnySolver few, many;  // up to tolerances::few_unknowns, and beyond
  };
  std::optional<Quadratic> without_friction = {};  // what is handed on goes to these; the registry gives them

  static std::vector<Setting<Cone>> settings() {
    return {{"finish", &Cone::finish, "Newton's method on the modes behind the interior point"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  class Work {
   public:
    void solve(Cone& cone, const Problem& problem, const SolveOptions& options, Solution& solution);

   private:
    void hand_on(Cone& cone, const Problem& problem, const SolveOptions& options, Solution& solution);
    void climb(const ConeStarts::Job& job);
    bool contradicts_itself(ConeStarts& normals, const ConeStarts::Job& job);

    ConeStarts starts_;
    Solution of_normals_;
    std::optional<Quadratic> quadratic_;
  };

  Islands islands_;
  ShapeCache<Work> works_;
  ShapeCache<ConeStarts> normals_;  // for the inequality rows alone, which have a shape of their own
};
static_assert(Solver<Cone>);

}  // namespace zwang
