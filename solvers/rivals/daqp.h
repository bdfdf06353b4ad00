#pragma once

#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/common/unit_program.h>

namespace zwang {

// DAQP (Arnstrom, Bemporad & Axehill 2022, "A dual active-set solver for embedded quadratic programming using recursive
// LDL' updates"; 0.9 through its C interface). The unit program is its own least-distance form already: no Hessian, no
// linear term, dense rows. It eliminates equality rows by a QR of its own where they are many (`eliminate`). T is its
// primal tolerance; its word is claimed as it is. Warm rows start active; where DAQP refuses them it starts cold.
// Stopped by a limit it has no iterate to show. One iteration is one active-set step.
struct Daqp {
  static constexpr auto name = "daqp";
  static constexpr Index most_unknowns = 2000, most_rows = 4000;  // its matrices are dense

  bool eliminate = true;
  int max_iterations = 100000;

  static std::vector<Setting<Daqp>> settings() {
    return {{"eliminate", &Daqp::eliminate, "equality rows by DAQP's own QR, where they are many"},
            {"max_iterations", &Daqp::max_iterations, "active-set steps before giving up"}};
  }
  std::string supports(const Problem& problem) const;
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  struct Workspace {
    UnitProgram program;
    Matrix Gt;  // n x k
    Vector lower, upper, y, lambda;
    std::vector<int> sense;
  };
  Workspace work = {};
};

static_assert(Solver<Daqp>);

}  // namespace zwang
