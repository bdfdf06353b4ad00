#pragma once

#include <array>
#include <string_view>

#include <zwang/solvers/friction/cone_program.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// What all of Siconos' solvers have in common: settings, workspace, and the check of what comes back.
struct SiconosWork {
  double ask = 1e-3;
  int max_iterations = 10000;
  ConeProgram program = {};
  Vector reaction = {}, velocity = {}, motion = {}, y = {}, slack = {};
  Matrix W = {};

  // In the local form u = W r + q, W the dense Delassus matrix, contacts scaled to a mean diagonal of 1.
  void solve_local(int method, const Problem& problem, const SolveOptions& options, Solution& solution);
  // In the global form M v = H r + q, u = H'v + b, sparse.
  void solve_global(int method, const Problem& problem, const SolveOptions& options, Solution& solution);
  static std::string supports(const Problem& problem, bool global);

 private:
  void judge(int code, const Problem& problem, const SolveOptions& options, Solution& solution);
};

// Siconos 4.4's numerics library (Acary, Bremond & Huber 2018, "On solving contact problems with Coulomb friction:
// formulations and numerical comparisons"), by the numbers of its Friction_cst.h.
//
// Its own error measure depends on units: it is asked for `ask` times the tolerance, and what it returns is measured
// again before `solved` is claimed. It knows no equality rows (joints are eliminated for the local form) and no rows
// without friction. Some of its solvers end the process on some input, so all run in a child process.
template <int method, bool global, Law law>
struct Siconos : SiconosWork {
  static constexpr std::string_view name = method == 500   ? "siconos_nsgs"
                                           : method == 504 ? "siconos_nsn_ac"
                                           : method == 513 ? "siconos_nsn_fb"
                                           : method == 517 ? "siconos_soclcp"
                                           : method == 523 ? "siconos_admm"
                                           : method == 605 ? "siconos_global_nsgs"
                                           : method == 613 ? "siconos_global_admm"
                                                           : "siconos_global_ipm";
  static constexpr std::array laws{law};

  static std::vector<Setting<Siconos>> settings() {
    return {{"ask", &Siconos::ask, "its tolerance, as a part of the one asked for"},
            {"max_iterations", &Siconos::max_iterations, "of its own, before giving up"}};
  }
  std::string supports(const Problem& problem) const { return SiconosWork::supports(problem, global); }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
    if constexpr (global)
      solve_global(method, problem, options, solution);
    else
      solve_local(method, problem, options, solution);
  }
};

using SiconosNsgs = Siconos<500, false, Law::coulomb>;
using SiconosNsnAc = Siconos<504, false, Law::coulomb>;
using SiconosNsnFb = Siconos<513, false, Law::coulomb>;
using SiconosSoclcp = Siconos<517, false, Law::convex>;
using SiconosAdmm = Siconos<523, false, Law::coulomb>;
using SiconosGlobalNsgs = Siconos<605, true, Law::coulomb>;
using SiconosGlobalAdmm = Siconos<613, true, Law::coulomb>;
using SiconosGlobalIpm = Siconos<615, true, Law::convex>;
static_assert(Solver<SiconosNsnFb>);

}  // namespace zwang
