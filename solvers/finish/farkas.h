#pragma once

#include <vector>

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/linalg/thin_qr.h>

namespace zwang {

// True when u, its negative inequality parts cut off, proves that no y meets the rows: any y would be at least
// h'u / |G'u| long (docs/formulation.md), and tolerances::referee_reach times the longest length of the problem stands
// for no y at all.
bool proves_infeasible(const UnitProgram& program, Vector& u, Vector& motion);

// Takes a proof found by iteration, with |G'u| near 1e-9 |u|, down to rounding: small parts are dropped, and the
// shortest correction d with G'(u + d) = 0 over the rest is added. Leaves u alone where that would lose the proof, or
// where the dense factorization would be large.
class Sharpening {
 public:
  void run(const UnitProgram& program, Vector& u);

 private:
  std::vector<Index> support_;  // rows with a part in u
  Matrix equations_;            // |support| x n: G over them, one column for each unknown
  ThinQr qr_;                   // of those that are independent
  Vector sharp_, kept_, motion_, part_;
};

}  // namespace zwang
