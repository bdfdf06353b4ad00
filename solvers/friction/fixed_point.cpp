#include <zwang/solvers/friction/fixed_point.h>

#include <algorithm>
#include <cmath>
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
bool FixedPoint::solve_shifted(const Problem& p, const SolveOptions& options, Solution& solution) {
  SolveOptions asked{.tolerance = std::clamp(share * iteration.residual(), tightest, loosest),
                     .memory_limit = options.memory_limit};
  asked.warm_start = solution.iterations > 0 ? &warm : options.warm_start;
  for (int widening = 0;; ++widening) {
    each_contact(p, [&](Index i) { shifted.c[i] = p.c[i] - p.mu[i] * sigma[i]; });
    asked.time_limit = iteration.deadline().left();
    solver->solve(shifted, asked, answer);
    if (has_answer(p, answer)) return true;
    if (answer.status != Status::infeasible || iteration.deadline().passed() || widening == widenings) return false;
    each_contact(p, [&](Index i) { sigma[i] = std::max(2 * sigma[i], slip(p, i, p.z_u)); });
    asked.warm_start = nullptr;
    ++solution.iterations;
  }
}

void FixedPoint::solve(const Problem& p, const SolveOptions& options, Solution& solution) {
  if (!iteration.begin(p, options, solution, ConeProgram::Want::way_back)) return;
  shifted = p;
  shifted.law = without_lift(p.law);
  warm.key = p.key;
  sigma.setZero(p.rows());
  while (iteration.goes_on(max_rounds)) {
    if (!solve_shifted(p, options, solution)) {
      solution.status = iteration.deadline().passed() ? Status::time_limit : Status::numerical_failure;
      solution.message = "no answer under the convex law by " + inner + ": ";
      solution.message += answer.message.empty() ? to_string(answer.status) : answer.message;
      break;
    }
    iteration.program.read(p, answer.z, answer.lambda, iteration.v, iteration.y);
    if (iteration.step_done()) break;
    warm.lambda = answer.lambda;
    each_contact(p, [&](Index i) { sigma[i] += relaxation * (slip(p, i, answer.z) - sigma[i]); });
  }
  iteration.end();
}

}  // namespace zwang
