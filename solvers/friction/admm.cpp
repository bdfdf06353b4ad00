#include <zwang/solvers/friction/admm.h>

#include <algorithm>

#include <zwang/solvers/law/second_order_cone.h>

namespace zwang {
namespace {

constexpr int settle = 20;               // steps between two looks at the penalty
constexpr double apart = 5, change = 3;  // of the residuals, and of the penalty then

}  // namespace

void Admm::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  if (!iteration.begin(problem, options, solution)) return;
  ConeProgram& program = iteration.program;
  ConeFace& face = program.face();
  Vector &v = iteration.v, &y = iteration.y, &s = iteration.s;
  const Index nc = program.cones();
  w.setZero(program.rows());
  sum.setZero(program.rows());
  double p = penalty, factorized = 0;
  long factor = 0;
  while (iteration.goes_on(max_steps)) {
    if (p != factorized || factor != program.factors()) {
      D.assign(at(9 * nc), 0);
      for (std::size_t k = 0; k < D.size(); k += 9) D[k] = D[k + 4] = D[k + 8] = p;
      ray_weight.setConstant(program.rays(), p);
      if (!program.factorize(D, ray_weight, true)) {
        solution.status = Status::numerical_failure;
        solution.message = "M + p G'G breaks down";
        break;
      }
      factorized = p;
      factor = program.factors();
    }
    sum = y + p * (w + program.h());
    face.force(sum, v);
    face.solve(v);
    program.slack(v, s);
    double primal = 0, dual = 0;
    for (Index k = 0; k < nc; ++k) {
      Vec3 own = s.segment<3>(3 * k);
      const double shift = program.law().shift(own.data());
      own[0] += shift;
      const Vec3 next = second_order_cone::projected(y.segment<3>(3 * k) - p * own);
      Vec3 now = own + (next - y.segment<3>(3 * k)) / p;
      primal = std::max(primal, (own - now).lpNorm<Eigen::Infinity>());
      now[0] -= shift;
      dual = std::max(dual, (now - w.segment<3>(3 * k)).lpNorm<Eigen::Infinity>());
      w.segment<3>(3 * k) = now;
      y.segment<3>(3 * k) = next;
    }
    for (Index i = 3 * nc; i < program.rows(); ++i) {
      const double next = program.is_equality(i - 3 * nc) ? y[i] - p * s[i] : std::max(0.0, y[i] - p * s[i]);
      const double now = s[i] + (next - y[i]) / p;
      primal = std::max(primal, std::abs(s[i] - now));
      dual = std::max(dual, std::abs(now - w[i]));
      w[i] = now;
      y[i] = next;
    }
    if (iteration.step_done()) break;
    if (solution.iterations % settle == 0) {
      const double ratio = primal / std::max(p * dual, std::numeric_limits<double>::min());
      if (ratio > apart || ratio < 1 / apart) p *= ratio > 1 ? change : 1 / change;
    }
  }
  iteration.end();
}

}  // namespace zwang
