#pragma once

#include <array>
#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/friction/contact_sweeps.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Nonsmooth Gauss-Seidel (Jourdan, Alart & Jean 1998; Jean 1999, Comput. Methods Appl. Mech. Eng. 177), on the sweeps
// of contact_sweeps.h: one iteration is one sweep. M may tie unknowns to each other in small groups only.
struct Nsgs {
  static constexpr std::string_view name = "nsgs";
  static constexpr std::array laws{Law::coulomb};
  static constexpr bool needs_friction = true;

  int max_sweeps = 10000;

  static std::vector<Setting<Nsgs>> settings() {
    return {{"max_sweeps", &Nsgs::max_sweeps, "sweeps over all contacts before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  ConeIteration iteration = {};
  ContactSweeps sweeps = {};
};
static_assert(Solver<Nsgs>);

}  // namespace zwang
