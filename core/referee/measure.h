#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/core/problem/reference.h>
#include <zwang/core/problem/solution.h>
#include <zwang/core/referee/friction/friction_metrics.h>

namespace zwang {

// What the referee finds, from the problem alone.
enum class Verdict {
  solved,              // z_error (or, without a reference, its upper bound) <= max(10 T, 1e-12), T the tolerance asked
  near,                // <= near_error(T)
  wrong,               // neither; or any z on an infeasible problem; or "infeasible" said of a feasible one
  infeasible_proven,   // the certificate holds in extended precision: no z within 1e8 motions
  infeasible_claimed,  // it does not hold, or there is none
  undecided,           // no reference, and the upper bound does not decide
  no_answer,           // the solver gave up without a z and said so
  timeout,             // stopped from outside at its deadline
  crashed,
  bad_input,
  unsupported,
  consistent,  // Coulomb's law: z is the convex answer for its own slip to the tolerance, but no solution is proven
               // near
  rows_off,    // Coulomb's law: what was proven near z is a solution of rows that are off by `delta`, not of these
};
inline constexpr Verdict last_verdict = Verdict::rows_off;

// How bad a verdict is: a total order. Of several verdicts the worst stands for all. An infeasibility that is proven is
// no fault: rows that push out of a wedge may contradict each other.
int severity(Verdict verdict);
inline Verdict worse(Verdict a, Verdict b) { return severity(a) < severity(b) ? b : a; }

// 1000 times what `solved` allows, but never more than a hundredth of the motion: beyond that nothing is near.
double near_error(double tolerance);

// Of a z whose error lies in [lower, upper], relative to s.
Verdict by_error(double upper, double lower, double tolerance);

// What a reference proves of a z at z_error from it: the distance to the nearest solution lies in [lower, upper],
// relative to s. Under Coulomb's law lower is 0 where the reference is not known to be the only one.
struct ErrorBounds {
  double upper = std::numeric_limits<double>::infinity(), lower = 0;
};
ErrorBounds error_bounds(const Problem& problem, const Reference& reference, double z_error);

std::string_view to_string(Verdict verdict);  // "solved", "infeasible, proven", "infeasible, claimed only", ...

// All residuals are in the M-norm on unit rows (row i divided by |G_i| = sqrt(J_i M^-1 J_i')), divided by the scale s
// (complementarity and gap by s^2): pure numbers. Multiply by s (s^2) for the absolute value in kg^1/2 m/s^2.
struct Metrics {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  Verdict verdict = Verdict::undecided;
  double scale = unknown;               // s = max(|z_u|_M, |z*|_M or |z|_M, smallest normal number)
  double z_error = unknown;             // |z - z*|_M / max(|z_u|_M, |z*|_M), when there is a reference
  double z_bound = unknown;             // upper bound on it that uses no reference
  double z_least = 0;                   // lower bound on it, as far as the verdict asked for one
  std::string bound_method = {};        // "active set", "opening" or "gap"
  double bound_sigma_min = unknown;     // sigma_min(G_A) of the active-set bound
  double primal = unknown;              // worst violated row
  double dual = unknown;                // most negative multiplier of an inequality row
  double stationarity = unknown;        // |y - G'lambda|
  double complementarity = unknown;     // worst |lambda_i slack_i|
  double gap = unknown;                 // 1/2 |y - G'lambda|^2 + lambda'(G y - h): bounds 1/2 |z - z*|^2 for feasible z
  double natural = unknown;             // worst |min(lambda_i, slack_i)|, scaled by the Delassus diagonal
  Index worst_row = -1;                 // of primal
  double farkas = unknown;              // h'u / |G'u| / s of the certificate, +Inf when G'u = 0 exactly
  std::vector<Index> conflicting = {};  // rows with a part in the certificate, largest first
  FrictionMetrics friction = {};        // of problems with tangent rows
};

// The referee. Works in extended precision where a claim rests on cancellation. Never throws on a bad solution: sizes
// that do not fit or a z with NaN are Verdict::wrong. `reference` may be null: the verdict then rests on z_bound.
Metrics measure(const Problem& problem, const Solution& solution, const Reference* reference, double tolerance);

}  // namespace zwang
