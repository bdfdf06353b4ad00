#include <algorithm>
#include <cmath>

#include <zwang/bench/references/wide_active_set.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/core/referee/bounds.h>
#include <zwang/core/referee/certificate.h>
#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {

std::optional<Reference> extended_reference(const Problem& problem) {
  WideActiveSet<long double> method;
  if (method.solve(problem) != Status::solved) return {};
  Solution answer;
  answer.reset(problem.size(), problem.rows());
  answer.status = Status::solved;
  answer.z = method.z.cast<double>();
  answer.lambda = method.lambda.cast<double>();
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_equality(i)) answer.lambda[i] = std::max(0.0, answer.lambda[i]);
  const Metrics metrics = measure(problem, answer, nullptr, referee::useful);
  if (metrics.bound_method != "active set" || !(metrics.z_bound <= referee::useful)) return {};
  return Reference{
      .z = answer.z, .lambda = answer.lambda, .bound = metrics.z_bound, .method = "long double, active-set bound"};
}

StoredTruth check_stored(const Problem& problem, const Reference& reference) {
  const double stated = reference.bound + referee::rounded_once;
  if (!bad_input(problem).empty()) return {Standing::refuted};
  if (problem.has_tangents()) {
    const Solution stored{.status = reference.feasible ? Status::solved : Status::infeasible,
                          .z = reference.z,
                          .lambda = reference.lambda,
                          .certificate = reference.certificate};
    const Metrics m = measure(problem, stored, nullptr, std::max(reference.bound, referee::rounded_once));
    if (m.verdict == Verdict::wrong) return {Standing::refuted};
    if (m.verdict == Verdict::infeasible_proven) return {Standing::certified};
    if (m.verdict == Verdict::solved && m.z_bound <= stated) return {Standing::certified, m.z_bound};
    return {};
  }
  const ScaledProblem scaled(problem);
  if (!scaled.definite) return {};
  const double free = std::max(scaled.norm_of_free_motion(), scaled.least_scale());
  if (!reference.feasible) {
    if (judge_certificate(scaled, reference.certificate, free).proven) return {Standing::certified};
    const ExtendedVector still = ExtendedVector::Zero(problem.size());
    const bool feasible = bound_distance(scaled, still, nullptr).rows == DistanceBound::Rows::feasible;
    return {feasible ? Standing::refuted : Standing::open};
  }
  if (reference.z.size() != problem.size() || !reference.z.allFinite()) return {Standing::refuted};
  ExtendedVector lambda;
  const bool has_lambda = reference.lambda.size() == problem.rows() && reference.lambda.allFinite();
  if (has_lambda) lambda = scaled.multipliers(reference.lambda);
  const DistanceBound bound = bound_distance(scaled, scaled.motion(reference.z), has_lambda ? &lambda : nullptr);
  if (bound.rows == DistanceBound::Rows::infeasible) return {Standing::refuted};
  const double upper = bound.upper / std::max(free, bound.least_norm);
  if (upper <= stated) return {Standing::certified, upper};
  return {bound.lower > stated * std::max(free, bound.greatest_norm) ? Standing::refuted : Standing::open};
}

double rounding_of(const Problem& problem, const Vector& z) {
  const Vector size = z.cwiseAbs();
  const auto length = [&](const Vector& v) { return std::sqrt(std::max(0.0, v.dot(problem.M * v))); };
  const double s = std::max(length(problem.z_u), length(z));
  const SparseMatrix M = problem.M.cwiseAbs();
  return s > 0 ? referee::up(referee::unit_roundoff * std::sqrt(size.dot(M * size)) / s) : 0;
}

double relative_distance(const Problem& p, const Vector& a, const Vector& b) {
  const ScaledProblem scaled(p);
  const double distance = scaled.norm(scaled.motion(a) - scaled.motion(b));
  return distance == 0 ? 0 : distance / std::max(scaled.norm_of_free_motion(), scaled.norm_of(a));
}

}  // namespace zwang
