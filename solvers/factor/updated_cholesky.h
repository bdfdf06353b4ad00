#pragma once

#include <span>

#include <zwang/core/problem/types.h>
#include <zwang/solvers/session.h>

namespace zwang {

// S_A = L D L' of a sparse symmetric matrix whose rows and columns come and go: CHOLMOD's simplicial factor with
// rowadd and rowdel (Davis & Hager 2005, SIAM J. Matrix Anal. 26). Rows that are out stand as rows of the identity.
//
// CHOLMOD's modify module, used here, is under the GPL.
//
// What CHOLMOD (SuiteSparse 5.12) does not say: rowadd accepts a pivot of -1.7e-17 with success, a singular
// factor solves to NaN with success, and a large update followed by its downdate leaves its error behind. So the
// caller asks rcond() after every change and checks residuals. False from any call: no memory, or a pivot that is not
// positive; the factor is then to be reset.
class UpdatedCholesky {
 public:
  bool reset(Index size);  // the identity; storage is kept when the size stays. Comes first, in a copy too
  // Column `at` of S: ascending indices among the rows that are in and `at` itself.
  bool add(Index at, std::span<const int> index, std::span<const double> value);
  bool remove(Index at);
  double smallest_pivot() const;  // of D
  double rcond() const;           // smallest over largest of D
  void solve(Vector& x) const;    // x := S_A^-1 x, length size

 private:
  struct Cholmod;
  Session<Cholmod> c_;
};

}  // namespace zwang
