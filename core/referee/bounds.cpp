#include <zwang/core/referee/bounds.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/exact_point.h>
#include <zwang/core/referee/island_split.h>
#include <zwang/core/referee/proof.h>
#include <zwang/core/referee/sparse_proof.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using Rows = DistanceBound::Rows;
using referee::or_infinity;

// The bound of the answer as it is: |y - y*|^2 <= 2 gap for feasible z and lambda_I >= 0. Its square root
// stops at 1e-8 for answers in double; a z outside a row by more than rounding gets no bound.
DistanceBound gap_bound(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector& given) {
  DistanceBound bound;
  ExtendedVector lambda = given;
  DoubleDouble weighted_slack;
  double rounding = 0;
  for (Index i = 0; i < scaled.rows(); ++i) {
    DoubleDouble& weight = lambda[i];
    if (!scaled.counts(i)) {
      if (scaled.is_zero(i) && !scaled.zero_row_holds(i)) return bound;
      weight = 0;
      continue;
    }
    const DoubleDouble slack = scaled.slack(i, d);
    const double error = scaled.rounding(i, d) * scaled.row_norm[i];
    const bool above = !scaled.is_equality(i) && slack.hi >= error;
    if (!above && !(slack == DoubleDouble(0) && scaled.slack_vanishes(i, d))) return bound;
    if (!scaled.is_equality(i) && weight.hi < 0) weight = 0;
    weighted_slack += weight * slack;
    rounding += std::abs(weight.hi) * (error + referee::rounding * slack.hi);
  }
  const double residual =
      scaled.dual_norm(scaled.force_residual(d, lambda)) * referee::widened_sum + scaled.force_rounding(d, lambda);
  bound.upper =
      std::sqrt(residual * residual + 2 * (std::max(0.0, weighted_slack.hi) + rounding)) * (1 + referee::widened);
  bound.least_norm = std::max(0.0, scaled.norm_with_free_motion(d) - bound.upper);
  bound.greatest_norm = scaled.norm_with_free_motion(d) + bound.upper;
  bound.method = "gap";
  bound.rows = Rows::feasible;
  return bound;
}

DistanceBound bound_in_doubles(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector* lambda,
                               double motion) {
  Proof proof;
  if (scaled.size() <= referee::dense_limit || scaled.rows() == 0) proof = prove_answer(scaled, d, lambda, motion);
  const bool gave_up = proof.rows != Rows::infeasible && proof.radius == infinity;
  if (gave_up && lambda) proof = prove_sparse(scaled, d, *lambda);
  DistanceBound bound{.sigma_min = proof.sigma_min, .rows = proof.rows};
  if (proof.rows == Rows::infeasible || proof.radius == infinity) {
    if (proof.rows == Rows::infeasible) bound.lower = std::max(0.0, proof.farther_than - scaled.norm(d));
    return proof.rows == Rows::infeasible || !lambda ? bound : gap_bound(scaled, d, *lambda);
  }
  const double distance = or_infinity(scaled.norm(d - proof.d)), norm = scaled.norm_with_free_motion(proof.d);
  bound.least_norm = std::max(0.0, norm - proof.radius) * (1 - referee::widened);
  bound.greatest_norm = (norm + proof.radius) * (1 + referee::widened);
  bound.upper = (distance + proof.radius) * (1 + referee::widened);
  bound.lower = std::max(0.0, distance - proof.radius) * (1 - referee::widened);
  bound.method = gave_up ? "opening" : "active set";
  return bound;
}

DistanceBound bound_island(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector* lambda,
                           double motion) {
  DistanceBound bound = bound_in_doubles(scaled, d, lambda, motion);
  if (bound.rows == Rows::infeasible || bound.upper <= referee::sharp_enough * motion) return bound;
  const Problem problem = scaled.problem();
  const Vector z = (d + problem.z_u.cast<DoubleDouble>()).cast<double>();
  const Vector forces = lambda ? Vector(lambda->cast<double>()) : Vector();
  if (const auto exact = exact_point(problem, z, {}, {&forces, 1}))
    bound = {.upper = referee::up(exact->distance),
             .lower = referee::down(exact->distance),
             .least_norm = referee::down(exact->size),
             .greatest_norm = referee::up(exact->size),
             .method = "rationals",
             .rows = Rows::feasible};
  return bound;
}

}  // namespace

DistanceBound bound_distance(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector* lambda) {
  for (Index i = 0; i < scaled.rows(); ++i)
    if (scaled.is_zero(i) && !scaled.is_vacuous(i) && !scaled.zero_row_holds(i)) return {.rows = Rows::infeasible};
  const std::vector<IslandPart> islands = split_islands(scaled.problem());
  // Of the whole, also for a part that does not move by itself: rows of it that turn apart by little may be met near
  // by.
  const double motion = std::max(scaled.norm_of_free_motion(), scaled.norm(d));
  if (islands.empty()) return bound_island(scaled, d, lambda, motion);
  DistanceBound total{.upper = 0, .greatest_norm = 0, .sigma_min = 1, .method = "active set", .rows = Rows::feasible};
  for (const IslandPart& island : islands) {
    const ScaledProblem own(island.problem);
    ExtendedVector part_lambda;
    if (lambda) part_lambda = own.multipliers(ExtendedVector((*lambda)(island.rows)));
    const DistanceBound part = bound_island(own, own.motion_of(d(island.columns)), lambda ? &part_lambda : nullptr,
                                            std::ldexp(motion, -own.norm_exponent()));
    total.upper = std::hypot(total.upper, own.to_problem_norm(part.upper));
    total.lower = std::hypot(total.lower, own.to_problem_norm(part.lower));
    total.least_norm = std::hypot(total.least_norm, own.to_problem_norm(part.least_norm));
    total.greatest_norm = std::hypot(total.greatest_norm, own.to_problem_norm(part.greatest_norm));
    total.sigma_min = std::min(total.sigma_min, part.sigma_min);
    if (part.method != "active set" && total.method != "gap") total.method = part.method;
    if (part.rows == Rows::infeasible || total.rows == Rows::infeasible)
      total.rows = Rows::infeasible;
    else if (part.rows == Rows::open)
      total.rows = Rows::open;
  }
  return total;
}

}  // namespace zwang
