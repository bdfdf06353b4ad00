#pragma once

#include <zwang/core/referee/proof.h>

namespace zwang {

// The same for problems too large for dense factors (stacks of hundreds of bodies), where all rows that touch can be
// opened at once. rows = open and no radius for all others, and for those with equality rows.
//
// The rows that push are solved as equalities by the method of multipliers, with residuals in double-double, so that
// redundant ones need no choice. Then, with e = y - G'mu (mu >= 0), s = G y - h and the true (y*, mu*),
//
//   |y - y*|^2 = e'(y - y*) + (mu - mu*)'(s - s*) <= |e| |y - y*| + mu'max(s, 0) + sum mu*_i v_i,   v = max(-s, 0),
//
// as mu*'s* = 0. For a feasible y_f with slack delta_i where v_i > 0,  sum mu*_i delta_i <= y*.(y_f - y*)  bounds the
// last sum: y_f = y + t p opens the rows that touch, G_i p > 0.
Proof prove_sparse(const ScaledProblem& gauge, const ExtendedVector& guess_d, const ExtendedVector& guess_lambda);

}  // namespace zwang
