#pragma once

#include <zwang/core/referee/proof.h>

namespace zwang {

// As prove_answer, for problems too large for dense factors (stacks of hundreds of bodies). It needs a motion that
// opens all rows that touch at once, and no equality rows; otherwise `rows` stays open and there is no radius.
//
// The active rows are solved as equalities by the method of multipliers, with residuals in double-double; redundant
// rows may stay among them. Then, with e = y - G'mu (mu >= 0), s = G y - h and the true (y*, mu*),
//
//   |y - y*|^2 = e'(y - y*) + (mu - mu*)'(s - s*) <= |e| |y - y*| + mu'max(s, 0) + sum mu*_i v_i,   v = max(-s, 0),
//
// as mu*'s* = 0. For a feasible y_f with slack delta_i where v_i > 0,  sum mu*_i delta_i <= y*.(y_f - y*)  bounds the
// last sum: y_f = y + t p opens the rows that touch, G_i p > 0.
Proof prove_sparse(const ScaledProblem& scaled, const ExtendedVector& guess_d, const ExtendedVector& guess_lambda);

}  // namespace zwang
