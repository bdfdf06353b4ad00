#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <zwang/solvers/newton/newton_polish.h>
#include <zwang/solvers/newton_start.h>
#include <zwang/solvers/prover.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Augmented-Lagrangian semismooth Newton, for large stacks: sparse all through.
//
// The augmented Lagrangian (augmented_lagrangian.h) is minimized over d by Newton's method, with an exact line search
// on the piecewise quadratic; then l := max(0, l + s (h - G d)) (Rockafellar 1976, Math. Oper. Res. 1; Li, Sun & Toh
// 2018, SIAM J. Optim. 28). Redundant rows do no harm: M > 0 keeps the matrix definite, and l stays finite as long as
// the rows agree. One iteration is one Newton step.
//
// From nothing that takes a step for each few rows that come or go. Of many unknowns `start`, the interior point of
// `cone`, leads to where the rows with a force can be told, in about as many steps for a heap as for a hand.
//
// Where the speed of the polish (newton_polish.h) cannot be trusted (near-parallel rows, contradictions), a problem
// small enough goes to the `dense` method (Solution::handed_to, with its iterations), dual_active_set; a larger one is
// reported as what it is. The registry gives both. With polish=off the method goes on alone until a step of l moves d
// by less than the tolerance. What was tried, and what fails: docs/notes/performance.md, walls.
struct Newton {
  static constexpr std::string_view name = "newton";
  double penalty = 100;  // s at the start
  bool hold_all = true;  // start from all near rows held
  bool inside = true;    // and else by an interior point
  bool polish = true;    // off: d and l as Newton's method leaves them, and no other method
  NewtonStart::Run start = {};
  std::optional<AnySolver> dense = {};

  static std::vector<Setting<Newton>> settings() {
    return {
        {"penalty", &Newton::penalty, "first weight of a violated unit row against M"},
        {"hold_all", &Newton::hold_all, "start from all rows near z_u held, where that pulls on few"},
        {"inside", &Newton::inside, "else by an interior point: many unknowns, no warm start, polish on"},
        {"polish", &Newton::polish,
         "solve the active rows again in extended precision, go to dual_active_set where that fails (off: neither)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  Status descend(const Problem& problem, double close, const SolveOptions& options, const Deadline& deadline,
                 Solution& solution);
  NewtonStart::End from_inside(const Problem& problem, const SolveOptions& options, const Deadline& deadline,
                               Solution& solution);
  Status run(const Problem& problem, bool all_but_known, const SolveOptions& options, const Deadline& deadline,
             Solution& solution);
  Status run_alone(const Problem& problem, const SolveOptions& options, const Deadline& deadline, Solution& solution);

  AugmentedLagrangian L_;
  NewtonPolish polish_;
  Prover* prover_ = nullptr;
  bool looks_ = false;  // on the way: elsewhere the polish has a bound of its own
  Vector before_;       // d before the inner problem
};
static_assert(Solver<Newton>);

}  // namespace zwang
