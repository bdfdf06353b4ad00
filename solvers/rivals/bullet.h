#pragma once

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// The two MLCP solvers most Bullet scenes run on today (Bullet 3.24, double precision, through their public
// interfaces), on the Delassus form over unit rows:
//
//   (G G' + cfm I) lambda - h = w,   lambda_I >= 0, w_I >= 0 complementary,   lambda_E free, w_E = 0.
//
// G G' is dense and formed in full, as Bullet does it: conditioning is squared, and redundant rows make it singular.
// The status is Bullet's own word, unrepaired: a true return value is claimed as solved
// wherever z is finite.

// btSolveDantzigLCP (after Baraff 1994, ODE's code): pivots row by row, and takes no tolerance. It reports no count:
// iterations is 1.
struct BulletDantzig {
  static constexpr auto name = "bullet_dantzig";
  static constexpr Index most_rows = 2000;  // dense n^2 storage and n^3 work

  double cfm = 0;  // constraint force mixing: added to the diagonal of unit rows

  static std::vector<Setting<BulletDantzig>> settings() {
    return {{"cfm", &BulletDantzig::cfm, "added to the diagonal of the Delassus matrix, unit rows"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
};

// btSolveProjectedGaussSeidel: sweeps until the squared change of lambda in one sweep falls below T^2. A step length is
// all it knows, so it stops early where it converges slowly. One iteration is one sweep; Bullet's return value is
// always true, so its sweep limit is told apart by the change it leaves behind.
struct BulletPgs {
  static constexpr auto name = "bullet_pgs";
  static constexpr Index most_rows = 2000;

  double cfm = 0;
  int max_sweeps = 10000;

  static std::vector<Setting<BulletPgs>> settings() {
    return {{"cfm", &BulletPgs::cfm, "added to the diagonal of the Delassus matrix, unit rows"},
            {"max_sweeps", &BulletPgs::max_sweeps, "sweeps over all rows before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
};

static_assert(Solver<BulletDantzig> && Solver<BulletPgs>);

}  // namespace zwang
