#pragma once

// What the native solvers decide by, each with its reason. No other literal tolerance decides anything
// (tests/structure/literals.cmake). Lengths, pivots and shares are of unit rows. A share is the length of a unit row
// outside the span of others: 1 orthogonal, 0 dependent. "In epsilons" means of the scalar at hand.
namespace zwang::tolerances {

// Rounding, in epsilons.

// What is left of a row that depends on others. Unit rows come out of whitening with an error of a few epsilons, and so
// do remainders that should be zero.
inline constexpr int rank = 64;
// Of the terms of a row: a violation. With 64, contradictions of 2^-42 (families GAP, INC) pass as feasible; with 8
// those of 2^-45 and less still do.
inline constexpr int violation = 8;
// A violation of a row outside the active set, in the wider scalar that answers are refined in: the answer carries the
// errors of all active rows.
inline constexpr int wide_violation = 32;
// With a hundred digits, instead of all of these: more digits than doubles can ask for. No row of theirs is meant to
// differ by less, while masses of a condition of 1e10 take ten digits, and rows that nearly repeat each other 13 each.
inline constexpr double hundred_digits = 1e-70;
// A refinement has ended where the next correction, about change^2 / size, is below this part of an epsilon.
inline constexpr double refined = 1.0 / 32;
// The rank decision of QrRows: between `violation` and `rank`, since two orthogonalizations leave little.
inline constexpr int share_rounding = 20;
// The least squares of NNLS end in r = 0: f = e_(n+1) is a combination of the passive columns.
inline constexpr int zero_residual = 50;
// A correction of the extended polish that is nothing to z; what is left of a multiplier of a proof.
inline constexpr int extended_change = 10, extended_multiplier = 16;
// The smallest pivot may be larger than the smallest singular value by about this factor.
inline constexpr int pivot_margin = 4;

// Pivots and shares.

// Fast paths leave problems with smaller pivots to careful ones: of a joint's rows, of loops and of active rows alike.
inline constexpr double clear_pivot = 1e-6;
// A dropped row of which more is left was not dropped by rounding alone: exactly dependent ones leave up to 2.4e-15 on
// 300 random hands.
inline constexpr double clear_rest = 4e-15;
// A row of a warm start with a smaller share is left to the method itself: the guess may be wrong.
inline constexpr double warm_share = 1e-7;
// Factors of S_A see the square of the condition number: below the first share they cannot tell a row from a
// combination (rcond near 1e-12), below the second it is one. Below this rcond of S_A corrections no longer contract.
inline constexpr double gram_share = 1e-6, gram_dependent = 1e-12, gram_rcond = 1e-13;
// What projecting out the equality rows leaves of a row in their span.
inline constexpr double projected_out = 1e-13;
// Columns of a least-squares problem (NNLS) that are dependent: closer than any row of doubles means to be.
inline constexpr double dependent_column = 1e-14;
// Relative size of a reflection's pivot among those that are large enough: strict pivoting would couple all of a hand.
inline constexpr double pivot_choice = 0.25;
// Columns of the equations of a Farkas vector that are left out of its correction; and the parts of a vector, relative
// to the largest, that take part in it.
inline constexpr double sharp_pivot = 1e-7, sharp_part = 1e-6;
// For rivals, which need clearly independent equality rows: squared share by LDL', share by QR.
inline constexpr double clear_squared_share = 1e-10, rival_dependent = 1e-12;

// The extended polish (solvers/finish/extended_polish.h).

// The least part in a combination with which an active row can leave for it; smaller ones are rounding of poses that
// agree only nearly. Rows of a proof's support with a larger share join the active ones.
inline constexpr double exchange_part = 1e-9, certain_share = 1e-9;
// Where the refinement does not converge, the weakest contact with a smaller pivot leaves.
inline constexpr double weak_pivot = 1e-10;
// As double factors see a share: larger ones need no combination in extended precision.
inline constexpr double clear_share = 1e-12;
// Of the motion: what obeying a row would move z by without anybody noticing.
inline constexpr double needless = 1e-13;
// Of its terms: a dependent row that is violated by less is left out, by more contradicts the others.
inline constexpr double dependent_violation = 1e-13;
// Of the motion: a multiplier this negative moves z by less.
inline constexpr double pull = 1e-15;
// Rows that hold with equality to this part of their terms, and have less than this share, are named redundant.
inline constexpr double touching = 1e-12, redundant_share = 1e-10;
// A correction this large relative to the one before is no contraction; it is good enough below this part of the
// motion.
inline constexpr double no_contraction = 0.3, stalled = 1e-6;

// Fast path of jointed bodies (solvers/active_set/joint_space_active_set.h).

// What the joints leave of a row that they determine: noise that a method would take for a row.
inline constexpr double reduced_to_nothing = 1e-13;
// What rounding mostly leaves of a row that the others determine exactly. More goes to the careful path.
inline constexpr double exact_share = 1e-16;
// Of a row's length: an entry that may be all a combination of rows leaves, and is less than the refinement sees.
inline constexpr double faint_share = 1e-20;
// A slack, of its terms, that rounding in double leaves no doubt about.
inline constexpr double clear_slack = 1e-12;
// Kahan's criterion: below this part of its squared length a remainder is orthogonalized once more.
inline constexpr double orthogonalize_again = 0.5;

// Steps.

// A multiplier that falls more slowly with the step never reaches zero.
inline constexpr double falling = 1e-13;
// NNLS changes its unit of length where |y| has outgrown it by this factor.
inline constexpr double outgrown = 8;
// In units of the largest violation: rows farther away than this cannot matter, and must not overflow; nor may the
// terms of a row, times a multiplier of zero.
inline constexpr double horizon = 1e100;
// Multipliers of a warm start that are this long where the motion's length is about 1 are another problem's: rounding
// in their sum would hide the rows.
inline constexpr double warm_start = 1e8;

// In the M-norm on unit rows: a column of entries no larger is left out (unit_rows.h). Its square is far below the
// rounding of long double.
inline constexpr double faint_entry = 1e-12;

// Newton's method (solvers/newton/newton.h); lengths relative to the motion.

// The polish is tried once a step of the multipliers moves d by less than the first, and again after the second.
inline constexpr double newton_close[] = {1e-5, 1e-9};
// How near the interior point leads to the answer.
inline constexpr double newton_inside = 1e-6;
// An inner problem is solved when its step is this part of the last outer one, or nothing at all.
inline constexpr double newton_inner = 1e-5, newton_nothing = 1e-13;
// The line search ends where its derivative has fallen by this factor.
inline constexpr double newton_line_search = 1e-9;
// The penalty grows tenfold where an outer step shrinks by less than this factor, up to a largest penalty; all near
// rows held take a penalty of their own (many unknowns: the second), and are kept where they pull with less than a
// quarter of what they push. Where steps choose rows after that they take the first: under more, slacks carry rounding
// into the choice.
inline constexpr double newton_slow = 0.1, newton_largest_penalty = 1e10, newton_hold = 1e6, newton_hold_many = 1e9,
                        newton_few_pull = 0.25;
// The polish ends with a correction this small; larger ones than the second tell the rate of convergence.
inline constexpr double newton_polished = 1e-17, newton_telling = 1e-15;
// Bounds that keep the estimate of the smallest eigenvalue finite.
inline constexpr double newton_least_rate = 1e-16, newton_least_eigenvalue = 1e-300;
// Of the motion: a bound on the error above which rows depend on each other so nearly that another method is asked.
inline constexpr double newton_doubt = 1e-4;
// A motion that was to open rows by 1 opens those that others do not all but determine by more; one that was to move
// equality rows by up to 1 misses those that are clearly independent by less.
inline constexpr double newton_unmoved = 1.0 / 32;
// Of the largest: smaller violations have no part in a Farkas vector.
inline constexpr double newton_part = 1e-9;

// Contacts with friction (solvers/friction); residuals relative to the motion, others of the worst violation.

// The gap at which the modes of contacts are first read off an interior point, by what it falls until they are read
// again, and where there is nothing more to read.
inline constexpr double cone_regime = 1e-7, cone_deeper = 1e-3, cone_deepest = 1e-45;
// The same where the shift of Coulomb's law is differentiated: at larger gaps its modes mislead.
inline constexpr double cone_coupled_regime = 1e-10;
// And along the central path, where its end is not near an answer before.
inline constexpr double cone_path_regime = 1e-16;
// A step of the first try that is shorter is blocked: the problem is a hard one. Close to an answer, where modes show
// next, only much shorter ones are.
inline constexpr double cone_blocked = 0.3, cone_blocked_close = 0.03;
// Along the central path: from that gap on, in units of the start's square, it is worth while to look where it leads;
// modes begin where that is so near an answer, in units of the motion, and again where it is that much nearer. A
// path that ended at a larger gap than the last met a fold: another one is followed.
inline constexpr double cone_in_sight = 1e-7, cone_near_end = 1e-9, cone_nearer = 0.01, cone_far_end = 1e-8;
// The least part of a correction on the spot.
inline constexpr double cone_least_correction = 1e-3;
// A natural residual below which little is spent on other starts: what is left is a claim, not a better z.
inline constexpr double cone_near = 1e-8;
// Interior point: the share of the way to the boundary, the least centring, and the part of the gap that rounds |s_t|.
inline constexpr double cone_to_boundary = 0.99, cone_least_centre = 1e-8, cone_slip_rounding = 0.01;
// The proximal term of Newton's method on the modes: at least the first, where the digits of a slack end, at most the
// second, and between them this many times the residual.
inline constexpr double cone_softness = 1e-6, cone_softest = 1e-3, cone_soften = 100;
// Residuals from which no Newton step on the modes led on: of an earlier frame's answer, and after six steps.
inline constexpr double cone_other_frame = 0.1, cone_lost = 3e-3;
// Of the square of the motion: what friction takes where contacts all but rest.
inline constexpr double cone_rests = 1e-3;
// Of the motion: a natural residual of sweeps from which Newton's method on the modes is tried.
inline constexpr double cone_swept = 1e-3;
// And across a slip, which may be 1e-9 of the motion beside loads of 1: at least the first, and the second times the
// residual.
inline constexpr double cone_least_across = 1e-10, cone_soften_across = 0.01;
// Over the softness: the most that a slip weighs beside a load where modes are told.
inline constexpr double cone_slip_weight = 0.01;
// Multipliers that have grown by this factor may prove that no motion meets the rows.
inline constexpr double cone_runs_off = 1e4;
// Of what a pivot of a 3 x 3 block was: what rounding leaves of nothing.
inline constexpr double cone_pivot = 1e-15;
// The rounding of the rows' push above which no answer is claimed, where less was not asked for; and from which on
// under the convex law the gap alone is believed.
inline constexpr double cone_push = 1e-8, cone_blind = 1e-11;
// A pivot of the sparse LU factors below this part of its column's largest gives way to that.
inline constexpr double coupled_pivot = 1e-3;
// A mu above this, or below its inverse, makes the rows N / mu and T of a cone so different that each has its own
// weight.
inline constexpr double cone_far = 0x1p10;
// A natural residual at which the modes hold to rounding; and one from which Newton's method will not come back.
inline constexpr double cone_exact = 1e-13, cone_hopeless = 1e-3;
// And, of the motion: one from which only a claim is missing where Newton's method on the modes does not settle; and
// one from which that goes on behind central paths: from farther off the interior point is the sooner there.
inline constexpr double cone_arrives = 1e-6, cone_near_behind = 3e-7;

// A promise (solvers/friction/promise.h), lengths relative to the motion. The proximal term at which active rows are
// met; what a dozen passes leave of multipliers, of rows that are independent; and the part that the shortest
// combination of rows is taken to have, at the least, in multipliers drawn at random.
inline constexpr double promise_softness = 1e-8, promise_vanished = 1e-6, promise_part = 1e-4;
// The slack with which a row is not touched whatever rounding does; and that of rows which the bound itself need not
// reach.
inline constexpr double promise_touching = 1e-9, promise_near = 1e-3;
// The largest bound of a refined answer that is told (joint_space_active_set.h).
inline constexpr double loosest_bound = 0x1p-26;

// A derivative (solvers/friction/solution_derivative.h), relative to the motion. What is nearer to another mode is a
// tie; the softness of its rows; what the next step would move forces by, times the root of it, where passes end; a row
// that neither opens nor is violated; rows that are met; and, in squares, larger motions that all but undo each other.
inline constexpr double derivative_tie = 1e-8, derivative_softness = 1e-9, derivative_ends = 0x1p-64;
inline constexpr double derivative_still = 1e-12, derivative_meets = 1e-9, derivative_undone = 1e4;
// Directions up to this length, and down to its inverse, have squares that are doubles.
inline constexpr double derivative_length = 1e150;

// Unknowns up to which rows are dense whatever they are, and a sparse method has nothing to gain.
inline constexpr int few_unknowns = 150;

// Contradictions.

// The referee takes a contradiction for proven where every motion that met the rows would be 1e8 times as long as the
// longest there is (core/referee/certificate.cpp). The solvers ask for as much again, for the rounding between.
inline constexpr double referee_reach = 1e8, out_of_reach = 2 * referee_reach;
// In units of rounding, of sum |u_i| max_j |J_ij|: what a proof may leave in an entry of J'u. Rows that are known to a
// rounding each leave half of one; with 8, rows 2^-47 from a combination were called contradicting.
inline constexpr int entry_rounding = 2;
// Of the sum of its terms: h'u of a proof that rounding could have made.
inline constexpr double proof_rounding = 1e-14;

// First-order methods and rivals.

// Of |y| before and after a step: growth that rounding can make (apgd).
inline constexpr double step_rounding = 1e-14;
// The KKT residual that double leaves of a right answer: no tolerance asks a rival for less.
inline constexpr double kkt_floor = 1e-13;
// NLopt: what a row may be violated by (with nothing, SLSQP returns its start as success), and the least step.
inline constexpr double nlopt_row = 1e-12, nlopt_step = 1e-14;

}  // namespace zwang::tolerances
