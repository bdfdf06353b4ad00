#pragma once

#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// A second witness of Coulomb's law, which knows no modes and shares no proof with interval Newton. z = (x, lambda_E,
// u) solves the law, lambda_i = P_K(u_i) at every contact i, where F(z) = 0,
//
//   F = (M x - J'lambda,  E x - h_E,  rho_i (s_i + mu |s_t,i| e_n) + u_i - P_K(u_i)),
//
// rho_i > 0, P_K the projection onto the contact's cone: the natural map lambda - P_K(lambda - rho (..)), with its
// argument u as the unknown. On a box Z about z_0, F(z) - F(z_0) = S (z - z_0) with S in an interval matrix [S]: P_K
// and |s_t| are made of a few smooth pieces, and the hull of the Jacobians of those that the box meets needs no strict
// modes. With R about an inverse of [S] and
//
//   K(Z) = z_0 - R F(z_0) + (I - R [S]) (Z - z_0),
//
// K(Z) inside Z proves that Z holds a solution and only one, K(Z) apart from Z that it holds none (Alefeld, Chen &
// Potra, Numer. Math. 83, 1999, and 92, 2002; Chen & Xiang, Math. Program. 106, 2006). In double, with bounds on
// rounding; F(z_0) in double-double. With lambda itself as the unknown, lambda and s widen u apart, and at the edge of
// a cone nothing contracts. Where contacts depend on each other [S] is singular, and nothing is proven. Dense: O(N^3),
// N unknowns and forces, up to referee::slopes_limit.
//
// A solution near (x, lambda), to which a few Newton steps are taken first.
ModeProof prove_by_slopes(const ContactProblem& problem, const ExtendedVector& x, const ExtendedVector& lambda);

// Is it proven that no solution is within `distance` of x, |.|_M? Of its forces nothing is assumed: the balance of
// forces bounds them, where contacts that may touch do not depend on each other.
bool none_by_slopes(const ContactProblem& problem, const ExtendedVector& x, double distance);

}  // namespace zwang
