#include <zwang/solvers/friction/fixed_point.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

// Of the residual: the tolerance of the next convex problem, between these two.
constexpr double share = 0.05, loosest = 0.01, tightest = tolerances::cone_exact;
constexpr int widenings = 8;  // of the slips, where the convex problem has no answer

// By which z lifts the row, over mu.
double slip(const Problem& p, Index row, const Vector& z) {
  double size = 0;
  for (Index t = 1; t <= p.tangents(row); ++t) size = std::hypot(size, p.J.row(row + t).dot(z) - p.c[row + t]);
  return lift_of(p.law) * size;
}

template <class Visit>
void each_contact(const Problem& p, Visit visit) {
  if (!p.has_tangents()) return;
  for (Index i = 0; i < p.rows(); ++i)
    if (!p.is_tangent(i) && p.mu[i] > 0 && p.tangents(i) > 0) visit(i);
}

bool has_answer(const Problem& p, const Solution& s) {
  return s.z.size() == p.size() && s.lambda.size() == p.rows() && s.z.allFinite() && s.lambda.allFinite();
}

}  // namespace

void FixedPoint::complete() {
  if (!(relaxation > 0 && relaxation <= 1))
    throw std::invalid_argument("solver 'fixed_point': setting relaxation=" + text_of(&relaxation) +
                                " should be above 0 and at most 1");
  solver = make(inner);
}

std::string FixedPoint::supports(const Problem& problem) const {
  Problem convex = problem;
  convex.law = without_lift(problem.law);
  const std::string reason = solver->supports(convex);
  return reason.empty() ? "" : inner + ": " + reason;
}

// The convex problem of the slips at hand; they grow where it has no answer.
bool FixedPoint::solve_shifted(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                               double tolerance, Solution& solution) {
  SolveOptions asked{.tolerance = tolerance, .memory_limit = options.memory_limit};
  asked.warm_start = solution.iterations > 0 ? &warm : options.warm_start;
  for (int widening = 0; widening <= widenings; ++widening) {
    each_contact(p, [&](Index i) { shifted.c[i] = p.c[i] - p.mu[i] * sigma[i]; });
    asked.time_limit = deadline.left();
    solver->solve(shifted, asked, answer);
    ++solution.iterations;
    if (has_answer(p, answer)) return true;
    if (answer.status != Status::infeasible || deadline.passed()) return false;
    each_contact(p, [&](Index i) { sigma[i] = std::max(2 * sigma[i], slip(p, i, p.z_u)); });
    asked.warm_start = nullptr;
  }
  return false;
}

// Of the answer, relative to the motion.
double FixedPoint::residual(const Problem& p, const SolveOptions& options, bool& accepted) {
  program.read(p, answer.z, answer.lambda, v, y);
  program.slack(v, s);
  const ConeProgram::Residual own = program.residual(y, s);
  const double unbalanced = v.isZero(0) && y.isZero(0) ? 0 : program.imbalance(v, y);
  accepted = unbalanced <= options.tolerance && program.accepts(own, v, options);
  // `accepts` asks the gap's bound on the distance for ten times the tolerance.
  const double scale = program.scale(v), apart = std::sqrt(2 * std::max(0.0, own.gap)) / 10;
  return std::max({own.natural / scale, apart / scale, unbalanced});
}

void FixedPoint::solve(const Problem& p, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (!program.build(p, ConeProgram::Want::way_back, options, deadline, solution)) return;
  promise.begin(p, options, &program);
  shifted = p;
  shifted.law = without_lift(p.law);
  warm.key = p.key;
  s.setZero(program.rows());
  sigma.setZero(p.rows());
  const int most = std::min(max_rounds, options.max_iterations);
  double left = 1, least = std::numeric_limits<double>::infinity();
  solution.status = Status::iteration_limit;
  while (solution.iterations < most) {
    if (deadline.passed()) {
      solution.status = Status::time_limit;
      break;
    }
    const double tolerance = std::clamp(share * left, tightest, loosest);
    if (!solve_shifted(p, options, deadline, tolerance, solution)) {
      solution.status = deadline.passed() ? Status::time_limit : Status::numerical_failure;
      solution.message = "no answer under the convex law by " + inner + ": ";
      solution.message += answer.message.empty() ? to_string(answer.status) : answer.message;
      break;
    }
    bool accepted = false;
    left = residual(p, options, accepted);
    if (promise.holds_at(y, solution)) return;
    if (left < least || accepted) {
      least = left;
      solution.z = answer.z;
      solution.lambda = answer.lambda;
    }
    if (options.observe) options.observe(solution.iterations, answer.z, answer.lambda);
    if (accepted) {
      solution.status = Status::solved;
      if (std::ranges::count(p.kind, RowKind::equality) == 0) promise.judge(p, options, solution);
      return;
    }
    warm.lambda = answer.lambda;
    each_contact(p, [&](Index i) { sigma[i] += relaxation * (slip(p, i, answer.z) - sigma[i]); });
  }
  if (!std::isfinite(least)) {
    solution.empty_answer();
  } else if (solution.message.empty()) {
    std::array<char, 80> text;
    std::snprintf(text.data(), text.size(), "the residual stays at %.1e of the motion", least);
    solution.message = text.data();
  }
}

}  // namespace zwang
