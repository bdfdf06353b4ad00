#pragma once

#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/rivals/peer_rows.h>

namespace zwang {

// ProxQP (Bambade, El-Kazdadi, Taylor & Carpentier 2022, "PROX-QP: yet another quadratic programming solver for
// robotics and beyond"; ProxSuite 0.7, headers only), proximal augmented Lagrangian, sparse. T is eps_abs, with eps_rel
// = 0, and bounds the duality gap: without that test, which ProxQP leaves out by default, a row may push without
// touching, and what it called solved was off by 1e-3. Its word is claimed as it is. It starts from the problem of the
// equality rows, which took fewer iterations than an earlier frame's multipliers (`warm`). One iteration is one inner
// Newton step. It takes no time limit.
struct Proxqp {
  static constexpr auto name = "proxqp";

  bool warm = false;
  int max_iterations = 10000;

  static std::vector<Setting<Proxqp>> settings() {
    return {{"warm", &Proxqp::warm, "start from an earlier frame's multipliers; slower on hands"},
            {"max_iterations", &Proxqp::max_iterations, "outer iterations before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  struct Workspace {
    UnitProgram program;
    RowsApart rows;
  };
  Workspace work = {};
};

static_assert(Solver<Proxqp>);

}  // namespace zwang
