#include <zwang/solvers/form/unit_program.h>

#include <algorithm>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

bool UnitProgram::build(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Preparation preparing;
  const Deadline deadline(options.time_limit);
  if (!begin<Whitened>(*this, problem, options, deadline, solution)) return false;
  if (rows() == 0) {
    solution.z = problem.z_u;
    solution.status = Status::solved;
    return false;
  }
  // Only what is violated at z_u sets the scale: a far-away inactive row must not.
  double largest = size() ? free.lpNorm<Eigen::Infinity>() : 0;
  for (Index i = 0; i < rows(); ++i) largest = std::max(largest, is_equality(i) ? std::abs(h[i]) : h[i]);
  int shift = 0;
  if (std::isfinite(largest)) (void)std::frexp(largest, &shift);
  shift = std::clamp(shift, -1000, 1000);
  sigma_ = std::ldexp(1.0, shift);
  h = (h / sigma_).cwiseMax(-tolerances::horizon);
  magnitude /= sigma_;
  free /= sigma_;
  free_norm /= sigma_;
  exponent += shift;
  return true;
}

std::vector<Index> UnitProgram::rows_of(bool equalities) const {
  std::vector<Index> chosen;
  for (Index i = 0; i < rows(); ++i)
    if (is_equality(i) == equalities) chosen.push_back(i);
  return chosen;
}

UnitProgram::Rows UnitProgram::some(const std::vector<Index>& rows) const {
  Rows chosen(std::ssize(rows), size());
  for (Index k = 0; k < chosen.rows(); ++k) {
    chosen.startVec(k);
    for (Rows::InnerIterator it(G, rows[at(k)]); it; ++it) chosen.insertBack(k, it.col()) = it.value();
  }
  chosen.finalize();
  return chosen;
}

void UnitProgram::motion(const Vector& lambda, Vector& y) const {
  y.setZero(size());
  for (Index i = 0; i < rows(); ++i)
    if (lambda[i] != 0) add(i, lambda[i], y);
}

void UnitProgram::slack(const Vector& y, Vector& slack) const {
  slack.resize(rows());
  for (Index i = 0; i < rows(); ++i) slack[i] = dot(i, y) - h[i];
}

void UnitProgram::project(Vector& lambda) const {
  for (Index i = 0; i < rows(); ++i)
    if (!is_equality(i)) lambda[i] = std::max(0.0, lambda[i]);
}

double UnitProgram::scale(const Vector& y) const {
  return std::max({free.norm(), (free + y).norm(), std::numeric_limits<double>::min()});
}

double UnitProgram::natural_residual(const Vector& y, const Vector& lambda) const {
  double worst = 0;
  for (Index i = 0; i < rows(); ++i) {
    const double slack = dot(i, y) - h[i];
    worst = std::max(worst, std::abs(is_equality(i) ? slack : std::min(lambda[i], slack)));
  }
  return worst / scale(y);
}

double UnitProgram::kkt_residual(const Vector& y, const Vector& lambda) const {
  const double stationarity = (y - G.transpose() * lambda).norm() / scale(y);
  return std::max(stationarity, natural_residual(y, lambda));  // NaN where y or lambda has one
}

double UnitProgram::reach() const { return std::max(free.norm(), rows() ? h.lpNorm<Eigen::Infinity>() : 0.0); }

void UnitProgram::warm_multipliers(const Problem& problem, const WarmStart* warm, Vector& lambda) {
  warm_rows_.multipliers(problem, *this, warm, lambda);
  if (!(lambda.lpNorm<1>() <= tolerances::warm_start)) lambda.setZero();
}

void UnitProgram::write(const Problem& problem, const Vector& y, const Vector& lambda, Solution& solution) const {
  primal(problem, y, solution.z);
  if (lambda.size() == rows())
    multipliers(problem, lambda, solution.lambda);
  else
    solution.empty_lambda();
}

void UnitProgram::write_certificate(const Problem& problem, const Vector& u, Solution& solution) const {
  multipliers(problem, u / sigma_, solution.zero_certificate(problem.rows()));
}

}  // namespace zwang
