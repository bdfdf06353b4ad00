#include <zwang/core/referee/measure.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/referee/bounds.h>
#include <zwang/core/referee/certificate.h>
#include <zwang/core/referee/friction/judge.h>
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/scaled_problem.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using referee::or_infinity;

// The six residuals, each on unit rows and divided by s (s^2).
void take_residuals(const ScaledProblem& scaled, const ExtendedVector& d, const ExtendedVector* lambda, double s,
                    Metrics& out) {
  out.primal = 0;
  if (lambda) out.dual = out.complementarity = out.natural = 0;
  DoubleDouble weighted_slack;
  const auto grow = [](double& worst, double value) { worst = std::max(worst, or_infinity(value)); };
  for (Index i = 0; i < scaled.rows(); ++i) {
    if (scaled.is_vacuous(i)) continue;
    const bool equality = scaled.is_equality(i);
    const DoubleDouble slack = scaled.slack(i, d);
    const double norm = scaled.row_norm[i];
    const double unit_slack = scaled.is_zero(i) ? (scaled.zero_row_holds(i) ? 0 : -infinity) : slack.hi / norm / s;
    const double violation = equality ? std::abs(unit_slack) : std::max(-unit_slack, 0.0);
    if (or_infinity(violation) > out.primal) {
      out.primal = or_infinity(violation);
      out.worst_row = i;
    }
    if (!lambda || scaled.is_zero(i)) continue;
    const DoubleDouble weight = (*lambda)[i];
    const double unit_lambda = weight.hi * norm / s;
    weighted_slack += weight * slack;
    grow(out.natural, std::abs(equality ? unit_slack : std::min(unit_lambda, unit_slack)));
    if (equality) continue;
    grow(out.dual, std::max(-unit_lambda, 0.0));
    grow(out.complementarity, std::abs(unit_lambda * unit_slack));
  }
  if (!lambda) return;
  out.stationarity = or_infinity(scaled.dual_norm(scaled.force_residual(d, *lambda)) / s);
  out.gap = out.stationarity * out.stationarity / 2 + or_infinity(weighted_slack.hi / s / s);
}

bool fits(const Vector& x, Index size) { return x.size() == size && x.allFinite(); }

// "No z meets the rows" is worth what its certificate is worth.
Verdict judge_infeasible(const Problem& problem, const ScaledProblem& scaled, const Solution& solution,
                         const Reference* reference, Metrics& out) {
  const double s = scaled.scale_of(0);
  const bool slips = problem.has_tangents();
  const Farkas farkas = judge_certificate(scaled, solution.certificate, s, slips ? &problem : nullptr);
  out.scale = scaled.to_problem_norm(s);
  out.farkas = farkas.distance / s;
  out.conflicting = farkas.conflicting;
  if (reference && reference->feasible) return Verdict::wrong;
  if (farkas.proven) return Verdict::infeasible_proven;
  if (reference) return Verdict::infeasible_claimed;
  const ExtendedVector still = ExtendedVector::Zero(scaled.size());
  const bool feasible = slips ? proven_feasible(problem, scaled, s)
                              : bound_distance(scaled, still, nullptr).rows == DistanceBound::Rows::feasible;
  return feasible ? Verdict::wrong : Verdict::infeasible_claimed;
}

Verdict judge_z(const Problem& problem, const ScaledProblem& scaled, const Solution& solution,
                const Reference* reference, double tolerance, Metrics& out) {
  const Index n = scaled.size(), m = scaled.rows();
  const bool known = reference && reference->feasible && fits(reference->z, n);
  const ExtendedVector d = scaled.motion(solution.z);
  ExtendedVector lambda;
  if (fits(solution.lambda, m)) lambda = scaled.multipliers(solution.lambda);
  const ExtendedVector* given = lambda.size() == 0 && m > 0 ? nullptr : &lambda;

  const double s = scaled.scale_of(or_infinity(scaled.norm_of(known ? reference->z : solution.z)));
  out.scale = scaled.to_problem_norm(s);
  take_residuals(scaled, d, given, s, out);
  ErrorBounds proven;
  if (known) {
    out.z_error = or_infinity(scaled.norm(d - scaled.motion(reference->z)) / s);
    proven = error_bounds(problem, *reference, out.z_error);
    const Verdict verdict = by_error(proven.upper, proven.lower, tolerance);
    if (verdict == by_error(out.z_error, out.z_error, tolerance)) return verdict;  // its own bound changes nothing
  }
  if (reference && !reference->feasible) return Verdict::wrong;

  const DistanceBound bound = bound_distance(scaled, d, given);
  // z_error is divided by max(|z_u|, |z*|): the bound takes the least that can be, the verdict "wrong" the greatest.
  out.z_bound = bound.upper / scaled.scale_of(bound.least_norm);
  out.bound_method = bound.method;
  out.bound_sigma_min = bound.sigma_min;
  if (bound.rows == DistanceBound::Rows::infeasible) return known ? Verdict::undecided : Verdict::wrong;
  proven.upper = std::min(proven.upper, out.z_bound);
  proven.lower =
      std::max({proven.lower, bound.lower / scaled.scale_of(bound.greatest_norm), referee::least_error(out.primal)});
  out.z_least = proven.lower;
  if (proven.lower > proven.upper) return Verdict::undecided;
  return by_error(proven.upper, proven.lower, tolerance);
}

}  // namespace

ErrorBounds error_bounds(const Problem& problem, const Reference& reference, double z_error) {
  const double off = reference.bound + referee::measured;
  const bool one = reference.unique || !referee::slip_lifts(problem.law) || !problem.has_tangents();
  return {z_error * (1 + referee::measured) + off, one ? std::max(z_error * (1 - referee::measured) - off, 0.0) : 0};
}

double near_error(double tolerance) {
  const double accepted = accepted_error(tolerance);
  return std::max(accepted, std::min(1000 * accepted, referee::nearest_wrong));
}

Verdict by_error(double upper, double lower, double tolerance) {
  if (upper <= accepted_error(tolerance)) return Verdict::solved;
  if (upper <= near_error(tolerance)) return Verdict::near;
  return lower > near_error(tolerance) ? Verdict::wrong : Verdict::undecided;
}

// By their order in the enum: how they are called, and how bad they are.
static constexpr std::pair<std::string_view, int> verdicts[] = {
    {"solved", 0},      {"near", 2},       {"wrong", 12},  {"infeasible, proven", 1}, {"infeasible, claimed only", 6},
    {"undecided", 5},   {"no answer", 7},  {"timeout", 9}, {"crashed", 10},           {"bad input", 11},
    {"unsupported", 8}, {"consistent", 4}, {"rows off", 3}};
static_assert(std::size(verdicts) == static_cast<std::size_t>(last_verdict) + 1);

std::string_view to_string(Verdict verdict) {
  const auto k = static_cast<std::size_t>(verdict);
  return k < std::size(verdicts) ? verdicts[k].first : "unknown verdict";
}

int severity(Verdict verdict) { return verdicts[static_cast<std::size_t>(verdict)].second; }

Metrics measure(const Problem& problem, const Solution& solution, const Reference* reference, double tolerance) {
  require_matching_sizes(problem);
  Metrics out;
  const auto with = [&out](Verdict verdict) {
    out.verdict = verdict;
    return out;
  };
  constexpr std::pair<Status, Verdict> without_answer[] = {{Status::unsolved, Verdict::no_answer},
                                                           {Status::numerical_failure, Verdict::no_answer},
                                                           {Status::crashed, Verdict::crashed},
                                                           {Status::unsupported, Verdict::unsupported},
                                                           {Status::bad_input, Verdict::bad_input}};
  for (const auto& [status, verdict] : without_answer)
    if (solution.status == status) return with(verdict);
  const bool has_z = fits(solution.z, problem.size());
  const bool stopped = solution.status == Status::time_limit;
  if (stopped && !has_z) return with(Verdict::timeout);
  if (!bad_input(problem).empty()) return with(Verdict::wrong);
  const ScaledProblem scaled(problem);
  if (!scaled.definite) return with(Verdict::undecided);
  if (solution.status == Status::infeasible) return with(judge_infeasible(problem, scaled, solution, reference, out));
  if (!has_z) return with(Verdict::wrong);
  const auto judge = problem.has_tangents() ? judge_friction : judge_z;
  const Verdict verdict = judge(problem, scaled, solution, reference, tolerance, out);
  const bool close = verdict == Verdict::solved || verdict == Verdict::near || verdict == Verdict::consistent;
  return with(stopped && !close ? Verdict::timeout : verdict);
}

}  // namespace zwang
