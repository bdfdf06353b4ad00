#include <zwang/bench/references/judge.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <zwang/bench/references/reference.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

std::string number(double x) { return printed("%.3g", x); }

std::string in_words(const Judgement& j, const char* variable) {
  std::string text(to_string(j.verdict));
  const std::string distance = std::string("|") + variable + " - " + variable + "*|";
  const std::string name(variable);
  const std::string relative = " (relative to max(|" + (name == "x" ? "P^-1 q" : name + "_u") + "|, |" + name + "*|))";
  if (std::isfinite(j.at_most))
    text += ": " + distance + " is at least " + number(j.at_least) + " and at most " + number(j.at_most) + relative;
  else if (j.at_least > 0)
    text += ": " + distance + " is at least " + number(j.at_least) + relative;
  // The motion without any row may be far larger than the answer, and an error that is small beside it may not be so
  // beside the answer.
  if (j.scale_over_answer > 2 && std::isfinite(j.scale_over_answer) && (std::isfinite(j.at_most) || j.at_least > 0))
    text += ", " + number(j.scale_over_answer) + " times that relative to |" + name + "*|";
  if (!j.worst_row.empty()) text += "; worst row: " + j.worst_row + ", violated by " + number(j.metrics.primal);
  return text + (j.proof.empty() ? "" : "; proof: " + j.proof);
}

// `rounding`: of the stored problem, relative to s.
Judgement judge(const Instance& instance, const Vector& z, const Vector& lambda, double tolerance, double rounding,
                const char* variable, const std::filesystem::path& cache) {
  const Problem& p = instance.problem;
  if (z.size() != p.size() || (lambda.size() != 0 && lambda.size() != p.rows()))
    throw std::invalid_argument(std::string(variable) + " should have " + std::to_string(p.size()) +
                                " entries and its multipliers " + std::to_string(p.rows()) + " or none; they have " +
                                std::to_string(z.size()) + " and " + std::to_string(lambda.size()));
  const Solution solution{.status = Status::solved, .z = z, .lambda = lambda};
  const FoundReference truth = reference_for(instance, cache);
  Judgement out;
  out.metrics = measure(p, solution, truth.reference ? &*truth.reference : nullptr, tolerance);
  const Metrics& m = out.metrics;
  out.verdict = m.verdict;
  if (m.worst_row >= 0 && m.primal > 0) out.worst_row = row_name(instance, m.worst_row);
  if (truth.reference && !truth.reference->feasible) {
    out.proof = truth.reference->method;
    out.text = "wrong: no " + std::string(variable) + " meets all rows; proof: " + out.proof;
    return out;
  }
  // A solution of rows that are off by delta bounds no distance to one of these.
  if (!std::isnan(m.z_bound) && !(m.friction.delta > 0)) {
    out.at_most = m.z_bound + rounding;
    out.proof = "the referee's bound (" + m.bound_method + ")";
  }
  if (truth.reference && !std::isnan(m.z_error)) {
    const ErrorBounds known = error_bounds(p, *truth.reference, m.z_error);
    out.at_least = std::max(known.lower - rounding, 0.0);
    if (!(out.at_most <= known.upper + rounding)) {
      out.at_most = known.upper + rounding;
      out.proof = truth.reference->method;
    }
  }
  out.at_least = std::max({out.at_least, m.z_least - rounding, referee::least_error(m.primal) - rounding});
  if (std::isinf(out.at_least)) out.at_least = 1;  // its square is beyond doubles
  // What contradicts itself proves nothing.
  if (out.at_least > out.at_most) {
    out.verdict = Verdict::undecided;
    out.at_least = 0;
    out.at_most = Metrics::unknown;
    out.proof = "";
  }
  // The referee does not know that z_u was rounded.
  if (rounding > 0 && std::isfinite(out.at_most)) out.verdict = by_error(out.at_most, out.at_least, tolerance);
  const Vector& answer = truth.reference ? truth.reference->z : z;
  if (answer.allFinite()) {
    const double size = std::sqrt(std::max(answer.dot(p.M * answer), 0.0));
    out.scale_over_answer = std::max(1.0, std::sqrt(std::max(p.z_u.dot(p.M * p.z_u), 0.0)) / size);
  }
  out.text = in_words(out, variable);
  return out;
}

}  // namespace

Judgement judge_infeasible(const Instance& instance, const Vector& certificate, const std::filesystem::path& cache) {
  const Solution solution{.status = Status::infeasible, .certificate = certificate};
  const FoundReference truth = reference_for(instance, cache);
  Judgement out;
  out.metrics = measure(instance.problem, solution, truth.reference ? &*truth.reference : nullptr, 0);
  out.verdict = out.metrics.verdict;
  if (out.verdict == Verdict::infeasible_proven) out.proof = "the certificate";
  if (out.verdict == Verdict::wrong) out.proof = "a z meets all rows";
  out.text = in_words(out, "z");
  return out;
}

Judgement judge(const Instance& instance, const Vector& z, const Vector& lambda, double tolerance,
                const std::filesystem::path& cache) {
  return judge(instance, z, lambda, tolerance, 0, "z", cache);
}

Judgement judge(const QuadraticProgram& program, const Vector& x, const Vector& y, const Vector& z, const Vector& z_box,
                double tolerance) {
  const AsLeastConstraint form = as_least_constraint(program);
  if (x.size() != program.q.size())
    throw std::invalid_argument("x should have " + std::to_string(program.q.size()) + " entries, and has " +
                                std::to_string(x.size()));
  const bool dual = y.size() + z.size() + z_box.size() > 0;
  const Vector lambda = dual ? form.multipliers(program, y, z, z_box) : Vector();
  const Problem& p = form.instance.problem;
  // s is at least |z_u|_M, up to the rounding of this product.
  const double s = std::sqrt(std::max(p.z_u.dot(p.M * p.z_u), 0.0)) / 2;
  const double rounding = form.rounding == 0 ? 0 : form.rounding / std::max(s, form.rounding * referee::unit_roundoff);
  return judge(form.instance, x, lambda, tolerance, rounding, "x", {});
}

}  // namespace zwang
