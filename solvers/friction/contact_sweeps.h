#pragma once

#include <vector>

#include <zwang/solvers/friction/cone_program.h>

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

}  // namespace zwang
