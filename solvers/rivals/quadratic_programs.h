#pragma once

#include <zwang/solvers/rivals/peer_rows.h>
#include <zwang/solvers/setting.h>

// Solvers of quadratic programs, each of the unit program (unit_program.h) in the form that its library asks for, each
// in the .cpp of its name.
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
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
  Matrix Gt = {};  // n x k
  Vector lower = {}, upper = {}, y = {}, lambda = {};
  std::vector<int> sense = {};
};

// OSQP (Stellato, Banjac, Goulart, Bemporad & Boyd 2020, "OSQP: an operator splitting solver for quadratic programs";
// 1.0 through its C interface, sparse), operator splitting, polished. T is eps_abs, with eps_rel = 0; its word is
// claimed as it is, but not what it calls inaccurate. Its dual ray is checked, and written where it is a proof. One
// iteration is one step of the splitting. Warm starts pass lambda and G'lambda.
struct Osqp {
  static constexpr auto name = "osqp";

  bool polish = true;
  int max_iterations = 100000;

  static std::vector<Setting<Osqp>> settings() {
    return {{"polish", &Osqp::polish, "a last step on the rows that look active"},
            {"max_iterations", &Osqp::max_iterations, "steps before giving up; OSQP's own default is 4000"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
};

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

  UnitProgram program = {};
  RowsApart rows = {};
};

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

  UnitProgram program = {};
  RowsApart rows = {};
};

// qpOASES (Ferreau, Kirches, Potschka, Bock & Diehl 2014, "qpOASES: a parametric active-set algorithm for quadratic
// programming"; 3.2), dense, with its own MPC options (`mpc`), which are several times faster here than its default and
// as right. T is its termination tolerance; its word is claimed as it is. It gives no dual ray. One iteration is one
// change of its working set. Warm starts pass the multipliers.
struct Qpoases {
  static constexpr auto name = "qpoases";
  static constexpr Index most_unknowns = 1000, most_rows = 2000;  // its matrices are dense

  bool mpc = true;
  int max_iterations = 100000;

  static std::vector<Setting<Qpoases>> settings() {
    return {{"mpc", &Qpoases::mpc, "qpOASES' options for model predictive control; off: its default options"},
            {"max_iterations", &Qpoases::max_iterations, "changes of the working set before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
  Matrix Gt = {};  // n x k
};

static_assert(Solver<Daqp> && Solver<Osqp> && Solver<Piqp> && Solver<Proxqp> && Solver<Qpoases>);

}  // namespace zwang
