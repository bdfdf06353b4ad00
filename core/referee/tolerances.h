#pragma once

#include <zwang/core/problem/types.h>
#include <zwang/core/referee/double_double.h>

// Every number that the referee decides by, with its reason. Lengths and slacks are of unit rows; "the motion" is s of
// docs/referee.md. Most of them steer a guess: where it is wrong there is no bound, never a false one.

namespace zwang::referee {

// Proof of infeasibility: every feasible z would be this many motions away, farther than any z that doubles hold to
// 1e-8. (Solvers ask for twice as much before they claim it: tolerances::out_of_reach.)
inline constexpr double farkas_margin = 1e8;
// Of the largest |u_i| |G_i|: below it a row has no part in the conflict that is named.
inline constexpr double no_part = 1e-10;
// Of the largest |u_i|: the rows that leave a direction inward no room. Only a guess: they are then held.
inline constexpr double locked = 1e-9;
// Of the terms of h'u: what it has to be where J'u vanishes in double-double. Less may be its rounding.
inline constexpr double no_gain = 1e-20;
// Pivots of unit rows, in double: smaller ones are rounding.
inline constexpr double projection_pivot = 1e-12;

// Rank of unit rows in FactorReal, in its epsilons times 1 + |coefficients|_1: Gram-Schmidt twice leaves a few.
inline constexpr int rank = 64;
// Remainder of a unit row that a direction inward is solved for; less would make the direction long.
inline constexpr FactorReal clear_rest = 1e-6L;
// What a direction inward has to do on each near row, of the 1 that it is solved for.
inline constexpr FactorReal reaches = 0.5L;

// Of the motion: rows that an answer in double touches. 1e-6 where there are no multipliers to tell, so that answers
// of a tolerance of 1e-6 find their rows; a row too many leaves by its multiplier's sign.
inline constexpr double touched = 1e-9;
inline constexpr double touched_by_guess = 1e-6;

// Double-double errs by 3 2^-106 a sum and 5 2^-106 a product, a row or a force of k terms by (6 k + 5) 2^-106 of them:
// 2^-98 covers 16 terms, and leaves what they do not use for the condition of M's blocks. It grows with their number.
inline constexpr double rounding = 0x1p-98;
inline constexpr double rounding_of(Index terms) {
  return terms > 16 ? rounding / 16 * static_cast<double>(terms) : rounding;
}
// A row outside the basis is violated from this many of its rounding bounds on.
inline constexpr double violated = 16;
// A row may hold with equality up to this many of them, and of the distance to the exact point.
inline constexpr double near = 64;
// How far a motion is moved inward, of the worst violation and rounding of a near row: g_i . v >= 1/2 then keeps four.
inline constexpr double inward = 8;
// Of the largest multiplier: a negative one is no rounding of refine(), which ends at 2^-100 of the first residual.
inline constexpr FactorReal negative = 1e-25L;
inline constexpr FactorReal refined = 0x1p-100L;
// Refinement failed where residuals did not fall by this much.
inline constexpr FactorReal unrefined = 1e-6L;
// Of the largest coefficient: a smaller one blocks no step, as it may be rounding of the factors.
inline constexpr FactorReal no_coefficient = 1e-15L;

// A bound that is this small, of the motion, is not worth a second try by moving inward.
inline constexpr double sharp_enough = 1e-14;
// Of s and the distance: the rounding of a distance that was measured in double-double, and its rounding to double.
inline constexpr double measured = 1e-15;
// What bounds are widened by for the rounding of their own few operations in double.
inline constexpr double widened = 1e-12;
// The same for sums of many terms and singular values in FactorReal.
inline constexpr double widened_sum = 1.01;

// The method of multipliers (sparse_proof.cpp), against M in double: each round leaves 1 / (1 + penalty sigma^2) of
// the error in the rows, and about 1e-16 penalty of that in the solves.
inline constexpr double penalty = 1e8;
// The least G_i p of a motion that opens all rows that touch, of the 1 that it is solved for.
inline constexpr double opens = 1e-3;
// The part of y*.(y_f - y*) that violations may take, so that the bound stays a small factor above it.
inline constexpr double largest_share = 0.25;
inline constexpr double widened_opening = 1e-9;

// Sizes of work. The dense proof works with matrices of FactorReal: on a wall of 400 boxes, 2400 unknowns, it took 90
// s.
inline constexpr Index dense_limit = 1500;           // unknowns
inline constexpr double dense_products = 1e9;        // of the factorizations of RefereeActiveSet
inline constexpr Index projected_entries = 4000000;  // of the matrix that judging a certificate factorizes
// Half a minute. A wall of 2000 bricks takes 0.2 % of it; where every row couples unknowns at random, the factor of
// 20000 of them would take hours.
inline constexpr double sparse_products = 2e10;
inline constexpr int refinements = 60;     // they halve the error or end; a right guess takes three
inline constexpr int projections = 4;      // of a certificate: each gains 16 digits until rounding in double-double
inline constexpr int inward_attempts = 4;  // each holds the rows that had no room in the one before

}  // namespace zwang::referee
