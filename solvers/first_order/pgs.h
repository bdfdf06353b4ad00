#pragma once

#include <zwang/solvers/first_order/dual_iteration.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Projected Gauss-Seidel on the dual of the whitened problem (docs/formulation.md, Delassus form; Jourdan, Alart &
// Jean 1998; Catto 2005 as "sequential impulses"):
//
//   minimize 1/2 lambda' G G' lambda - h' lambda   over lambda_I >= 0,
//
// one row after the other, with y = G' lambda kept up to date so that the Delassus matrix is never formed.
// One iteration is one sweep over the rows. The answer to a tolerance T is claimed only when, recomputed from lambda,
// the natural residual is <= T and the distance still to go, from the contraction seen so far, is <= T as well.
// Mass ratios and tall stacks make the contraction slow; the sweep limit then ends it, which is said.
struct Pgs {
  static constexpr auto name = "pgs";

  double relaxation = 1.0;  // 0 < relaxation < 2
  int max_sweeps = 10000;

  static std::vector<Setting<Pgs>> settings() {
    return {{"relaxation", &Pgs::relaxation, "step on each row as a share of the exact one, 0 < relaxation < 2"},
            {"max_sweeps", &Pgs::max_sweeps, "sweeps over all rows before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  DualIteration iteration = {};
  Vector before = {};
};

static_assert(Solver<Pgs>);

}  // namespace zwang
