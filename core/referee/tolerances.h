#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/number/double_double.h>
#include <zwang/core/problem/types.h>

// Every number that the referee decides by, with its reason. Lengths and slacks are of unit rows; "the motion" is s of
// docs/referee.md. Most of them steer a guess: where it is wrong there is no bound, never a false one.

namespace zwang::referee {

// Proof of infeasibility: every feasible z would be this many motions away, farther than any z that doubles hold to
// 1e-8. (Solvers ask for twice as much before they claim it: tolerances::out_of_reach.)
inline constexpr double farkas_margin = 1e8;
// Of the motion: what is farther than this is not near, whatever tolerance was asked for.
inline constexpr double nearest_wrong = 1e-2;
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
// (k + 8) 2^-100 leaves the rest for the condition of M's blocks. `rounding` is for what is compared with a sum of
// ordinary length.
inline constexpr double rounding = 0x1p-98;
constexpr double rounding_of(Index terms) { return static_cast<double>(terms + 8) * 0x1p-100; }
// Of what a few operations in double-double make, roots and quotients (2^-100 each) among them.
inline constexpr double rounding_of_few = 0x1p-96;
inline constexpr double unit_roundoff = 0x1p-53;
// What products that underflow may lose, of numbers near 1; and what is lost under a root. Slips and forces below the
// latter are zero.
inline constexpr double underflow = 1e-290, underflow_of_squares = 1e-140;
// No power of two has changed such a number.
inline bool ordinary(double x) { return x == 0 || (std::abs(x) > 1e-280 && std::abs(x) < 1e280); }
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

// A bound that is this small, of the motion, is not worth a second try: by moving inward, or in wider arithmetic.
inline constexpr double sharp_enough = 1e-13;
// Of s and the distance: the rounding of a distance that was measured in double-double, and its rounding to double.
inline constexpr double measured = 1e-15;
// What bounds are widened by for the rounding of their own operations in double, sums of positive terms.
inline constexpr double widened = 1e-9;
constexpr double up(double bound) { return bound * (1 + widened); }
constexpr double down(double bound) { return bound * (1 - widened); }
// What overflowed to NaN is as bad as can be.
inline double or_infinity(double bound) { return std::isnan(bound) ? infinity : bound; }
// Every solution meets normal and equality rows: a z that is off by p is p / 2 of the larger motion away from it, less
// what p, which is measured, may be too large by. What overflowed says nothing.
inline double least_error(double primal) {
  return std::isfinite(primal) ? std::max(0.0, down(std::min(1.0, primal) / 2) - measured) : 0;
}
// The same for what a factor of M in FactorReal has a part in: proven_definite() leaves it right to 1 %.
inline constexpr double widened_sum = 1.01;

// The method of multipliers (sparse_proof.cpp), against M in double: each round leaves 1 / (1 + penalty sigma^2) of
// the error in the rows, and about 1e-16 penalty of that in the solves.
inline constexpr double penalty = 1e8;
// The least G_i p of a motion that opens all rows that touch, of the 1 that it is solved for.
inline constexpr double opens = 1e-3;
// The part of y*.(y_f - y*) that violations may take, so that the bound stays a small factor above it.
inline constexpr double largest_share = 0.25;

// The interior point (friction/interior_point.cpp): iterations; those without a gain before it ends, a gain being a
// merit below this much of the best; the longest step that is told; the least centring; the part of the way to the
// edge.
inline constexpr int interior_steps = 80, interior_stalls = 12;
inline constexpr double interior_gain = 0.9, interior_reach = 1e6, interior_centre = 1e-4, interior_way = 0.98;

// Targets of its complementarity: in double, in double-double, for points inside the cones, and for a motion that is
// merely well inside. How far the cones are moved in for points inside, of the motion.
inline constexpr double interior_target = 1e-18, interior_target_extended = 1e-27, interior_target_inside = 1e-20,
                        interior_target_rough = 1e-3;
inline constexpr double interior_inward[] = {1e-3, 1e-6};
// Under friction: a bound that is this small is not worth Newton's method on the modes, dense in the rows, where they
// are many.
inline constexpr double good_enough = 1e-10;
// What an inner point's distance from the answer counts at least when one is chosen to move to.
inline constexpr double inner_cost = 1e-12;
// A row of zeros this near the edge of its cone, of its own size, is on it.
inline constexpr double on_edge = 0x1p-90;
// Of a contact's |lambda| + |s| in doubles: less is zero for a first guess at its mode, and for a second.
inline constexpr double mode_cut = 1e-9, coarse_mode_cut = 1e-6;
// Of the motion: the slip that a contact begins with when it leaves stick.
inline constexpr double first_slip = 1e-3;
// Newton's method on the modes: pivots of unit rows in double; residuals below it fall by refinement with the factors
// at hand; a step that ends it; a step that is small enough to try a proof.
inline constexpr double mode_pivot = 1e-11, refine_below = 1e-9, refined_modes = 1e-31, polished = 1e-12;
// Pivots that are tried for the independent part of a proof, the likeliest first.
inline constexpr double independent_pivots[] = {1e-11, 1e-8, 1e-13};
// Relative to the motion: what rounding of dependent rows leaves of modes that hold. Where such modes solve other rows
// only, it is worth to change some by the last digits that there are.
inline constexpr double holds = 1e-13;
// Of mu l_n: a part of the friction that may be zero exactly.
inline constexpr double aligned = 1e-20;
// How far an interval is widened before it is tried again.
inline constexpr double inflated = 1.5;

// References. What one's bound may be, and what rounding it once to doubles may add, or part two of one answer.
inline constexpr double useful = 1e-9, rounded_once = 1e-14;
// What a solution of Coulomb's law may be off and still count as found; the distance of the motion at which solutions
// of changed rows are one; what a unit change of multipliers moves z by at least, or leaves it where it is.
inline constexpr double good_delta = 1e-12, alike = 1e-9, still = 1e-8;
// The change of a sweep of Gauss-Seidel, of the motion, at which it ends.
inline constexpr double settled = 1e-15;

// Sizes of work. The dense proof works with matrices of FactorReal: on a wall of 400 boxes, 2400 unknowns, it took 90
// s.
inline constexpr Index dense_limit = 1500;           // unknowns
inline constexpr Index dense_rows = 2000;            // rows, under friction
inline constexpr double dense_products = 1e9;        // of the factorizations of RefereeActiveSet
inline constexpr Index projected_entries = 4000000;  // of the matrix that judging a certificate factorizes
// Half a minute. A wall of 2000 bricks takes 0.2 % of it; where every row couples unknowns at random, the factor of
// 20000 of them would take hours.
inline constexpr double sparse_products = 2e10;
inline constexpr double exact_products = 3e7;  // modular ones, of the exact question about dropped rows
inline constexpr Index extended_rows = 400;    // of the interior point of jointed problems in double-double
inline constexpr Index slopes_limit = 400;     // unknowns and forces together of the proof by slopes
inline constexpr Index searched_rows = 120;    // the same in a search for solutions, from many starts
// rows^3 of all factorizations of a search, and of one chase of modes: no start and no change of modes after them.
inline constexpr double searched_products = 2e10;
inline constexpr Index polished_rows = 600, self_rows = 1200;  // for Newton on the modes; for self_bound with joints
inline constexpr int refinements = 60;                         // they halve the error or end; a right guess takes three
inline constexpr int projections = 4;      // of a certificate: each gains 16 digits until rounding in double-double
inline constexpr int inward_attempts = 4;  // each holds the rows that had no room in the one before

// Proofs of a part under friction are dense; they are tried up to these sizes.
inline bool may_prove(Index unknowns, Index rows) {
  return rows == 0 || (unknowns <= dense_limit && rows <= dense_rows);
}

}  // namespace zwang::referee
