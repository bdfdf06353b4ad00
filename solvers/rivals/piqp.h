#pragma once

#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/rivals/peer_rows.h>

namespace zwang {

// PIQP (Schwan, Jiang, Kuhn & Jones 2023, "PIQP: a proximal interior-point quadratic programming solver"; 0.6, headers
// only), sparse. T is eps_abs, with eps_rel = 0, and T^2/2 (>= 1e-14) the duality gap, for a gap of T would leave y
// off by sqrt(T). Its word is claimed as it is. One iteration is one interior-point iteration. It takes no start and no
// time limit.
struct Piqp {
  static constexpr auto name = "piqp";

  bool condensed = false;
  int max_iterations = 250;

  static std::vector<Setting<Piqp>> settings() {
    return {{"condensed", &Piqp::condensed, "rows are eliminated from the system of each step"},
            {"max_iterations", &Piqp::max_iterations, "interior-point iterations before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  struct Workspace {
    UnitProgram program;
    RowsApart rows;
  };
  Workspace work = {};
};

static_assert(Solver<Piqp>);

}  // namespace zwang
