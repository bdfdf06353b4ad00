#pragma once

#include <array>
#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Over the contacts of a cone program, one after the other, each contact's 3 x 3 problem under Coulomb's law solved
// exactly with the others as they are: a contact that slides has u_t = -a r_t with the one a >= 0 at which |r_t| = mu
// r_n, a root in one unknown. Then over the single rows.
class ContactSweeps {
 public:
  bool begin(ConeProgram& program);  // false where M ties too many unknowns to each other (cone_face.h)
  // v = M^-1 G'y stays so.
  void sweep(ConeProgram& program, Vector& v, Vector& y) const;

 private:
  std::vector<Mat3> block_;  // of the Delassus matrix
  Vector diagonal_;          // of the single rows
};

// Nonsmooth Gauss-Seidel (Jourdan, Alart & Jean 1998; Jean 1999, Comput. Methods Appl. Mech. Eng. 177): one contact
// after the other, its 3 x 3 problem under Coulomb's law solved exactly. A contact that slides has u_t = -a r_t with
// the one a >= 0 at which |r_t| = mu r_n, a root in one unknown. One iteration is one sweep. M may tie bodies to each
// other in small groups only.
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
  ContactSweeps sweeps = {};
};
static_assert(Solver<Nsgs>);

}  // namespace zwang
