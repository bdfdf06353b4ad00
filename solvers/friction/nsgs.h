#pragma once

#include <array>
#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Nonsmooth Gauss-Seidel (Jourdan, Alart & Jean 1998; Jean 1999, Comput. Methods Appl. Mech. Eng. 177): one contact
// after the other, its 3 x 3 problem under Coulomb's law solved exactly. A contact that slides has u_t = -a r_t with
// the one a >= 0 at which |r_t| = mu r_n, a root in one unknown. One iteration is one sweep. Dense form only.
struct Nsgs {
  static constexpr std::string_view name = "nsgs";
  static constexpr std::array laws{Law::coulomb};

  int max_sweeps = 10000;

  static std::vector<Setting<Nsgs>> settings() {
    return {{"max_sweeps", &Nsgs::max_sweeps, "sweeps over all contacts before giving up"}};
  }
  std::string supports(const Problem& problem) const;
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  ConeIteration::Workspace inner = {};
  std::vector<Mat3> block = {};  // of the Delassus matrix
  Vector diagonal = {};          // of the single rows
};
static_assert(Solver<Nsgs>);

}  // namespace zwang
