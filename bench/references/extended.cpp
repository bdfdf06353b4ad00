#include <cmath>

#include <zwang/bench/references/witnesses.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/active_set/goldfarb_idnani.h>

namespace zwang {

std::optional<Reference> extended_reference(const Problem& problem) {
  GoldfarbIdnani<long double> method;
  if (method.solve(cast<long double>(problem), {}) != Status::solved || !method.contracted) return {};
  Solution answer;
  answer.reset(problem.size(), problem.rows());
  answer.status = Status::solved;
  answer.z = method.z().cast<double>();
  answer.lambda = method.lambda().cast<double>();
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_equality(i)) answer.lambda[i] = std::max(0.0, answer.lambda[i]);
  constexpr double useful = 1e-9;
  const Metrics metrics = measure(problem, answer, nullptr, useful);
  if (metrics.bound_method != "active set" || !(metrics.z_bound <= useful)) return {};
  return Reference{
      .z = answer.z, .lambda = answer.lambda, .bound = metrics.z_bound, .method = "long double, active-set bound"};
}

double relative_distance(const Problem& p, const Vector& a, const Vector& b) {
  using Real = long double;
  const auto length = [&](const VectorX<Real>& v) {
    const Real top = v.size() > 0 ? v.lpNorm<Eigen::Infinity>() : Real(0);
    if (top == 0) return Real(0);
    Real sum = 0;
    for (Index j = 0; j < p.M.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it)
        sum += (v[it.row()] / top) * Real(it.value()) * (v[j] / top);
    return top * std::sqrt(std::max(Real(0), sum));
  };
  const Real size = std::max(length(p.z_u.cast<Real>()), length(a.cast<Real>()));
  const Real distance = length(a.cast<Real>() - b.cast<Real>());
  return distance == 0 ? 0 : static_cast<double>(distance / size);
}

}  // namespace zwang
