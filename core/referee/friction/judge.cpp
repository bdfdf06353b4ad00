#include <zwang/core/referee/friction/judge.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <zwang/core/problem/law.h>
#include <zwang/core/referee/bounds.h>
#include <zwang/core/referee/exact_point.h>
#include <zwang/core/referee/friction/interval_newton.h>
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/friction/natural_map.h>
#include <zwang/core/referee/friction/numbers.h>
#include <zwang/core/referee/friction/self_bound.h>
#include <zwang/core/referee/island_split.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::down, referee::least_error, referee::or_infinity, referee::slip_lifts, referee::up;

constexpr double enough = .01;  // of what is asked for: a bound of the convex answer that need not be smaller

double distance(const ContactProblem& p, const ExtendedVector& a, const ExtendedVector& b) {
  return or_infinity(p.norm(a - b));
}

// sigma(z) under Coulomb's law. Under the convex law 0.
Slips slips_at(const ContactProblem& p, const ExtendedVector& x, Law law) {
  Slips out(std::ssize(p.contacts));
  for (Index c = 0; c < out.error.size() && slip_lifts(law); ++c) {
    out.sigma[c] = p.slip(p.contacts[at(c)], x);
    out.error[c] = p.slip_error(p.contacts[at(c)], x);
  }
  return out;
}

bool may_bound(const ContactProblem& p) {
  return referee::may_prove(p.size(), p.rows()) && (p.equalities.empty() || p.rows() <= referee::self_rows);
}

// Do the normal and equality rows contradict each other? Every solution meets them. Found by the proofs without
// friction, from z.
bool rows_contradict(const Problem& problem, const Vector& z) {
  const Problem rows = under(no_friction, problem);
  const ScaledProblem scaled(rows);
  return bound_distance(scaled, scaled.motion(z), nullptr).rows == DistanceBound::Rows::infeasible;
}

// The proven solution of Coulomb's law that is nearest to x, of those from each guess until one is near enough.
struct Nearest {
  ModeProof proof;
  double upper = infinity;  // |z - solution|_M
};

void consider(const ContactProblem& p, const ExtendedVector& x, ModeProof proof, Nearest& nearest) {
  if (!proof.proven) return;
  const double upper = up(distance(p, x, proof.point.x) + proof.radius);
  // A solution of these rows comes before one of others, however near.
  const bool exact = proof.delta == 0, exact_before = nearest.proof.proven && nearest.proof.delta == 0;
  const auto off = [](const ModeProof& by, double far) { return far + by.delta; };
  if (nearest.proof.proven &&
      (exact != exact_before ? exact_before : !(off(proof, upper) < off(nearest.proof, nearest.upper))))
    return;
  nearest.upper = upper;
  nearest.proof = std::move(proof);
}

// What can be proven of an answer, in the units of a ContactProblem, in the M-norm.
struct Found {
  Nearest nearest = {};
  ConvexBound::Rows rows = ConvexBound::Rows::feasible;  // under the answer's slips
  double upper = 0, lower = 0;                           // |z - Z(sigma(z))| is at most, |z - any solution| at least
  double convex_size = 0, convex_error = 0;              // |Z(sigma(z))|, up to so much
  double nearest_size = 0;                               // of the proven solution

  // Of two parts that share nothing.
  void join(const Found& other);
};

void Found::join(const Found& other) {
  const auto add = [](double& a, double b) { a = up(std::hypot(a, b)); };
  ModeProof& proof = nearest.proof;
  proof.proven &= other.nearest.proof.proven;
  proof.strict &= other.nearest.proof.strict;
  proof.unique_forces &= other.nearest.proof.unique_forces;
  proof.by = std::max(proof.by, other.nearest.proof.by);
  proof.null_motion = std::max(proof.null_motion, other.nearest.proof.null_motion);
  add(proof.radius, other.nearest.proof.radius);
  add(proof.delta, other.nearest.proof.delta);
  add(nearest.upper, other.nearest.upper);
  add(upper, other.upper);
  add(convex_error, other.convex_error);
  lower = down(std::hypot(lower, other.lower));
  convex_size = std::hypot(convex_size, other.convex_size);
  nearest_size = std::hypot(nearest_size, other.nearest_size);
  if (other.rows == ConvexBound::Rows::infeasible) rows = other.rows;
}

// Of a part without rows: its answer is z_u, x = 0.
Found found_free(const ContactProblem& p, const ExtendedVector& x) {
  const double off = p.norm(x), size = p.norm_of_free_motion();
  Found found{.upper = up(off), .lower = down(off), .convex_size = size, .nearest_size = size};
  found.nearest = {.proof = {.proven = true, .radius = 0, .delta = 0, .strict = true, .unique_forces = true},
                   .upper = found.upper};
  return found;
}

// With d = |z - z*|, |Z(sigma(z)) - z*| <= sqrt(2 C d) (self_bound.h), and so off <= d + sqrt(2 C d).
double distance_to_solutions(double off, double turn) {
  if (!(turn < infinity)) return 0;
  const double root = 2 * off / (std::sqrt(2 * turn + 4 * off) + std::sqrt(2 * turn));
  return down(root * root);
}

// The last witness: in rationals.
void consider_exactly(const Problem& problem, const ContactProblem& p, const ExtendedVector& x,
                      const ExtendedVector& lambda, const ConvexBound& convex, Found& found) {
  Nearest& nearest = found.nearest;
  const auto forces = [&](const ExtendedVector& of) -> Vector { return p.to_multipliers(of).cast<double>(); };
  std::vector<Vector> points, guesses;
  if (lambda.size() > 0) guesses.push_back(forces(lambda));
  if (nearest.proof.proven) {
    points.push_back(p.rounded_motion(nearest.proof.point.x));
    guesses.push_back(forces(nearest.proof.point.lambda));
  }
  if (convex.upper < infinity) {
    points.push_back(p.rounded_motion(convex.x));
    guesses.push_back(forces(convex.lambda));
  }
  const auto exact = exact_point(problem, p.rounded_motion(x), points, guesses);
  if (!exact) return;
  const auto own = [&](double norm) { return std::ldexp(norm, -p.norm_exponent()); };
  const double distance = own(exact->distance), size = own(exact->size);
  if (!slip_lifts(problem.law)) {
    found.rows = ConvexBound::Rows::feasible;
    found.upper = up(distance);
    found.lower = down(distance);
    found.convex_size = size;
    found.convex_error = referee::measured * size;
  } else if (!nearest.proof.proven || nearest.proof.delta > 0 || distance < nearest.upper) {
    nearest = {.proof = {.proven = true, .radius = 0, .delta = 0, .by = "rationals"}, .upper = up(distance)};
    found.nearest_size = down(size);
  }
}

Found find(const Problem& problem, const ContactProblem& p, const ExtendedVector& x, const ExtendedVector& lambda,
           double tolerance) {
  const bool coulomb = slip_lifts(problem.law), has_lambda = lambda.size() > 0;
  const Slips slips = slips_at(p, x, problem.law);
  ModePoint guess{x, lambda, {}};
  if (has_lambda) guess.modes = modes_by_size(p, x, lambda, referee::mode_cut);
  Found found;
  Nearest& nearest = found.nearest;
  const double accepted = accepted_error(tolerance);
  const auto within = [&](double far) {
    return nearest.proof.proven && nearest.proof.delta == 0 && nearest.upper <= far * p.scale;
  };
  if (coulomb && has_lambda) consider(p, x, prove_near(p, guess), nearest);
  // Z(sigma(z)), or under the convex law its one answer.
  ConvexBound convex;
  if (may_bound(p)) {
    if (nearest.proof.proven) guess = nearest.proof.point;
    const bool needs_less = !coulomb || within(accepted);  // beside a proof it may only contradict
    convex = bound_convex(p, slips, guess.modes.empty() ? nullptr : &guess,
                          std::max(needs_less ? enough * accepted * p.scale : 0, referee::sharp_enough));
  }
  found.rows = convex.rows;
  found.upper = infinity;
  if (convex.upper < infinity) {
    const double off = distance(p, x, convex.x);
    found.upper = up(off + convex.upper);
    found.lower = std::max(0.0, down(off) - convex.upper);
    if (coulomb) {
      const bool far = found.lower > near_error(tolerance) * p.scale;
      found.lower = far ? distance_to_solutions(found.lower, bound_turn(p)) : 0;
    }
    found.convex_size = p.norm_with_free_motion(convex.x);
    found.convex_error = convex.upper;
  }
  if (!coulomb) {
    if (found.rows != ConvexBound::Rows::infeasible && found.upper > accepted * p.scale)
      consider_exactly(problem, p, x, lambda, convex, found);
    return found;
  }
  if (!within(accepted) && convex.upper < infinity) consider(p, x, prove_near(p, convex), nearest);
  if (!within(infinity) && (nearest.proof.proven || convex.upper < infinity)) {
    const ModePoint& from = nearest.proof.proven ? nearest.proof.point : convex;
    consider(p, x, prove_by_slopes(p, from.x, from.lambda), nearest);
  }
  // A little more than what makes z wrong.
  const double wrong = 1.001 * near_error(tolerance), far = wrong < 1 ? wrong / (1 - wrong) * p.scale : infinity;
  if (!within(near_error(tolerance)) && found.lower < far && far < infinity && none_by_slopes(p, x, far))
    found.lower = far;
  if (nearest.proof.proven) found.nearest_size = p.norm_with_free_motion(nearest.proof.point.x);
  if (found.rows != ConvexBound::Rows::infeasible && !within(accepted))
    consider_exactly(problem, p, x, lambda, convex, found);
  return found;
}

// Each part apart, in the units of the whole.
Found find_apart(const std::vector<IslandPart>& islands, const ScaledProblem& scaled, const Solution& solution,
                 bool has_lambda, double scale, double tolerance) {
  std::optional<Found> all;
  for (const IslandPart& island : islands) {
    const ScaledProblem part(island.problem);
    const ContactProblem p(island.problem, part, std::ldexp(scale, scaled.norm_exponent() - part.norm_exponent()));
    const ExtendedVector x = p.motion(solution.z(island.columns));
    ExtendedVector lambda;
    if (has_lambda) lambda = p.multipliers(solution.lambda(island.rows));
    const Found found = island.rows.empty() ? found_free(p, x) : find(island.problem, p, x, lambda, tolerance);
    all ? all->join(found) : void(all = found);
  }
  return *all;
}

// z = z_u = 0: with lambda = 0 the slacks are -c, without rounding, and where no row asks for a motion, rest is a
// solution of Coulomb's law, whatever multipliers come with it. There is no motion to measure errors by, and in units
// of the least double there is, slips overflow.
bool rests_exactly(const Problem& problem, const Solution& solution) {
  if (!slip_lifts(problem.law) || !problem.z_u.isZero(0) || !solution.z.isZero(0)) return false;
  for (Index i = 0; i < problem.rows(); ++i)
    if (problem.is_equality(i) ? problem.c[i] != 0 : !problem.is_tangent(i) && !(problem.c[i] <= 0)) return false;
  return true;
}

}  // namespace

// Coulomb's law has a solution wherever some z opens all contacts that can move to the inside of K*.
bool proven_feasible(const Problem& problem, const ScaledProblem& scaled, double motion_scale) {
  const ContactProblem p(problem, scaled, motion_scale);
  if (!may_bound(p)) return false;
  Slips slips = slips_at(p, ExtendedVector::Zero(p.size()), problem.law);
  for (Index c = 0; c < slips.sigma.size(); ++c)
    if (p.contacts[at(c)].unit > 0) slips.sigma[c] = 0, slips.error[c] = 0;
  const ConvexBound bound = bound_convex(p, slips, nullptr);
  return slip_lifts(problem.law) ? bound.interior : bound.rows == ConvexBound::Rows::feasible;
}

Verdict judge_friction(const Problem& problem, const ScaledProblem& scaled, const Solution& solution,
                       const Reference* reference, double tolerance, Metrics& out) {
  const bool has_lambda = solution.lambda.size() == problem.rows() && solution.lambda.allFinite();
  const bool known = reference && reference->feasible && reference->z.size() == problem.size();
  const double own_scale = scaled.scale_of(
      std::max(or_infinity(scaled.norm_of(solution.z)), known ? scaled.norm_of(reference->z) : 0));
  if (!std::isfinite(own_scale)) return Verdict::wrong;
  // The squares of all motions vanish beside a row that is 2^500 times as large.
  const bool moves = !problem.z_u.isZero(0) || !solution.z.isZero(0);
  if (moves && !(own_scale > scaled.least_scale())) return Verdict::undecided;
  const ContactProblem p(problem, scaled, own_scale);
  const ExtendedVector x = p.motion(solution.z);
  ExtendedVector lambda;
  if (has_lambda) lambda = p.multipliers(solution.lambda);
  out.scale = scaled.to_problem_norm(own_scale);
  out.friction = friction_residuals(p, problem.law, x, has_lambda ? &lambda : nullptr);
  out.primal = out.friction.penetration;
  for (const Index i : p.equalities)
    out.primal = std::max(out.primal, or_infinity(std::abs(p.slack(i, x).hi) / p.row_norm[i] / p.scale));
  out.natural = out.friction.natural;
  out.complementarity = out.friction.complementarity;
  if (has_lambda) {
    out.dual = out.friction.cone_violation;
    out.stationarity = or_infinity(p.dual_norm(p.force_residual(x, lambda)) / p.scale);
  }
  const double accepted = accepted_error(tolerance);
  ErrorBounds from_reference;
  if (known) {
    out.z_error = distance(p, x, p.motion(reference->z)) / p.scale_of(p.norm_of(reference->z));
    from_reference = error_bounds(problem, *reference, out.z_error);
    const Verdict verdict = by_error(from_reference.upper, from_reference.lower, tolerance);
    if (!slip_lifts(problem.law) && verdict != Verdict::undecided) return verdict;
  }
  if (reference && !reference->feasible) return Verdict::wrong;
  if (rests_exactly(problem, solution)) {
    out.z_bound = out.friction.self_bound = out.friction.radius = out.friction.delta = 0;
    out.bound_method = "rows met without rounding";
    return Verdict::solved;
  }
  const std::vector<IslandPart> islands = split_islands(problem);
  const auto may = [](const auto& part) { return referee::may_prove(part.size(), part.rows()); };
  from_reference.lower = std::max(from_reference.lower, least_error(out.primal));
  if (islands.empty() ? !may(p) : !std::ranges::all_of(islands, may, &IslandPart::problem))
    return from_reference.lower > from_reference.upper
               ? Verdict::undecided
               : by_error(from_reference.upper, from_reference.lower, tolerance);
  const Found found = islands.empty() ? find(problem, p, x, lambda, tolerance)
                                      : find_apart(islands, scaled, solution, has_lambda, own_scale, tolerance);
  if (found.rows == ConvexBound::Rows::infeasible) return Verdict::wrong;
  double upper = infinity, lower = 0;
  if (found.upper < infinity) {
    upper = found.upper / p.scale_of(found.convex_size - found.convex_error);
    // The larger of |z| and |z_u| is p.scale, and the solution may be longer by its distance.
    lower = found.lower / (p.scale + found.lower);
  }
  if (!slip_lifts(problem.law)) {
    out.z_bound = upper;
    out.bound_method = upper < infinity ? "conic duality" : "";
    return by_error(std::min(upper, from_reference.upper), std::max(lower, from_reference.lower), tolerance);
  }
  out.friction.self_bound = upper;
  if (const Nearest& nearest = found.nearest; nearest.proof.proven) {
    const double least = p.scale_of(found.nearest_size - nearest.proof.radius);
    out.z_bound = nearest.upper / least;
    out.bound_method = nearest.proof.by;
    out.friction.radius = nearest.proof.radius / least;
    out.friction.delta = nearest.proof.delta / least;
    out.friction.null_motion = nearest.proof.null_motion;
    out.friction.strict = nearest.proof.strict;
    out.friction.isolated = nearest.proof.strict && nearest.proof.unique_forces;
    const Verdict verdict = by_error(out.z_bound, 0, tolerance);
    const bool exact = nearest.proof.delta == 0;
    // Proofs that contradict each other prove nothing.
    if (exact && std::max(lower, from_reference.lower) > out.z_bound) return Verdict::undecided;
    if (exact && (verdict == Verdict::solved || (verdict == Verdict::near && !(upper <= accepted)))) return verdict;
  }
  if (!known && rows_contradict(problem, solution.z)) return Verdict::wrong;
  lower = std::max(lower, from_reference.lower);
  if (lower > from_reference.upper) return Verdict::undecided;
  if (const Verdict near = by_error(from_reference.upper, 0, tolerance); near != Verdict::undecided) return near;
  if (lower <= accepted && std::max(out.z_bound, out.friction.delta) <= accepted) return Verdict::rows_off;
  if (upper <= accepted && lower <= accepted) return Verdict::consistent;
  return lower > near_error(tolerance) ? Verdict::wrong : Verdict::undecided;
}

}  // namespace zwang
