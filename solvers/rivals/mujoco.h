#pragma once

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/session.h>
#include <zwang/solvers/setting.h>

namespace zwang {

class MujocoSession;

// MuJoCo's Newton solver (Todorov 2014, "Convex and analytically-invertible dynamics with contacts and constraints";
// MuJoCo 2.2.2 through its public interface), on the whitened problem:
//
//   minimize 1/2 |y|^2 + stiffness/2 sum_i r_i^2,   r_E = G_E y - h_E,  r_I = min(0, G_I y - h_I).
//
// Its rows are soft by design: each gives way by its force / stiffness, and no stiffness makes that nothing. So this is
// a yardstick of speed, not a solver of the problem asked for, and it never proves infeasibility. On unit rows MuJoCo's
// hardest impedance, 0.9999, is a stiffness of 1e4. Solved is claimed only where the hard problem's KKT check holds to
// T / 100 all the same (z is up to 25 times further off than the rows give way, on small random problems); otherwise
// the point counts as a last iterate (iteration limit). The message says by how much the rows gave way.
//
// Newton's steps are exact on each set of violated rows, so few are needed; the search along a step is exact too. T^2,
// or MuJoCo's own 1e-8 where that is less, bounds what a last step gains in the objective. One iteration is one step.
// It cannot be interrupted.
struct MujocoNewton {
  static constexpr auto name = "mujoco_newton";
  static constexpr Index most_unknowns = 1000, most_rows = 2000;  // its workspace is dense

  double stiffness = 1e4;
  int max_steps = 100;

  static std::vector<Setting<MujocoNewton>> settings() {
    return {{"stiffness", &MujocoNewton::stiffness, "of unit rows; MuJoCo's own impedances go up to 1e4"},
            {"max_steps", &MujocoNewton::max_steps, "Newton steps before giving up"}};
  }
  std::string supports(const Problem&) const { return stiffness > 0 ? "" : "its stiffness should be above 0"; }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
  Session<MujocoSession> opened = {};
};

static_assert(Solver<MujocoNewton>);

}  // namespace zwang
